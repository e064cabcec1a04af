#include "registration/temporal_start.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numbers.h"
#include "core/statistics.h"

namespace fathom {

namespace {

constexpr double kValley = 0.5;       // of the best squared correlation: between two peaks it falls lower
constexpr double kRival = 4.0;        // unexplained share of another peak over that of the best
constexpr double kRivalLeast = 0.03;  // and at most this, whatever the noise
constexpr std::size_t kMedianFrames = 5;

std::string milliseconds(double seconds) { return format_rounded(1e3 * seconds, 0) + " ms"; }

struct Correlated {
  double latency_s = 0.0;
  double squared = 0.0;  ///< correlation
  int frames = 0;
};

Correlated correlate(const Signal& image, const SmoothSignal& tracker, double latency_s) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  const double image_shift = image.values.front().value;  // keeps the sums small
  for (const TimedValue& value : image.values) {
    const auto place = tracker.roughly_at(value.time_s + latency_s);
    if (!place) continue;
    const double depth = value.value - image_shift;
    n += 1.0;
    x += *place;
    y += depth;
    xx += *place * *place;
    xy += *place * depth;
    yy += depth * depth;
  }
  const double both = n * xy - x * y;
  const double product = (n * xx - x * x) * (n * yy - y * y);
  return {latency_s, product > 0.0 ? both * both / product : 0.0, static_cast<int>(n)};
}

/// The correlations over the range, those with enough frames.
std::vector<Correlated> correlations(const Signal& image, const SmoothSignal& tracker, const TemporalOptions& options) {
  std::vector<Correlated> all;
  const int steps = static_cast<int>(std::ceil(options.max_latency_s / kLatencyStep_s));
  int most = 0;
  for (int i = -steps; i <= steps; ++i) {
    all.push_back(correlate(image, tracker, options.max_latency_s * i / steps));
    most = std::max(most, all.back().frames);
  }
  // Few frames resemble anything.
  const int enough = std::max(options.min_frames, most / 2);
  std::erase_if(all, [&](const Correlated& c) { return c.frames < enough; });
  return all;
}

bool is_peak(const std::vector<Correlated>& all, std::size_t i) {
  return i > 0 && i + 1 < all.size() && all[i].squared >= all[i - 1].squared && all[i].squared > all[i + 1].squared;
}

/// The highest peak beyond a valley on either side of the best one.
std::optional<Correlated> rival_of(const std::vector<Correlated>& all, std::size_t best) {
  std::optional<Correlated> rival;
  for (const int direction : {-1, 1}) {
    bool beyond = false;
    for (auto i = static_cast<std::ptrdiff_t>(best); i >= 0 && i < static_cast<std::ptrdiff_t>(all.size());
         i += direction) {
      const auto at = static_cast<std::size_t>(i);
      beyond = beyond || all[at].squared < kValley * all[best].squared;
      if (beyond && (is_peak(all, at) || at == 0 || at + 1 == all.size()) &&
          (!rival || all[at].squared > rival->squared)) {
        rival = all[at];
      }
    }
  }
  return rival;
}

}  // namespace

Signal without_spikes(const Signal& signal) {
  Signal result = signal;
  const std::size_t count = signal.values.size();
  constexpr std::size_t kHalf = kMedianFrames / 2;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> near;
    const std::size_t first = i < kHalf ? 0 : i - kHalf;
    for (std::size_t k = first; k < std::min(count, first + kMedianFrames); ++k) near.push_back(signal.values[k].value);
    result.values[i].value = median(std::move(near));
  }
  return result;
}

double latency_start(const Signal& image, const SmoothSignal& tracker, const TemporalOptions& options,
                     const std::string& both) {
  const std::vector<Correlated> all = correlations(image, tracker, options);
  if (all.empty()) {
    throw Error(both + ": share too little time (fewer than " + std::to_string(options.min_frames) +
                " frames with poses); check that both were recorded at the same time, with one clock");
  }
  const auto best = static_cast<std::size_t>(
      std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.squared < b.squared; }) -
      all.begin());
  const double correlation = std::sqrt(all[best].squared);
  if (correlation < options.min_correlation) {
    throw Error(both + ": the floor's depth does not follow the probe (correlation " + format_rounded(correlation, 2) +
                "); check that both were recorded together, and move the probe straight up and down over a flat floor");
  }
  if (!is_peak(all, best)) {
    throw Error(both + ": no latency within " + milliseconds(options.max_latency_s) +
                " stands out; move the probe up and down several times, or allow more by --max-latency-s");
  }
  const auto rival = rival_of(all, best);
  if (rival && 1.0 - rival->squared < std::max(kRival * (1.0 - all[best].squared), kRivalLeast)) {
    throw Error(both + ": the motion repeats itself, so that latencies of about " + milliseconds(all[best].latency_s) +
                " and " + milliseconds(rival->latency_s) +
                " fit alike; move the probe irregularly, or limit the latency by --max-latency-s");
  }
  return all[best].latency_s;
}

}  // namespace fathom
