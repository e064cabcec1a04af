#include "registration/still_periods.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/statistics.h"

namespace fathom {

namespace {

constexpr double kLeastSpeed_mm_s = 1e-6;  // its logarithm is finite
constexpr double kSpeedRatio = 5.0;        // of fast to slow: less is one kind of motion
constexpr double kOutlying = 4.0;          // distance from the middle of a period, in medians

struct Sample {
  int frame = 0;
  double time_s = 0.0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
};

std::vector<Sample> samples_of(const ProbePoses& tool, const Eigen::Vector3d& tip_in_tool_mm) {
  if (!tool.has_times()) {
    throw Error(tool.recording() +
                ": its time stamps are missing or do not increase, so rests cannot be found; record "
                "with time stamps");
  }
  std::vector<Sample> samples;
  for (int frame = 0; frame < tool.frame_count(); ++frame) {
    const auto i = static_cast<std::size_t>(frame);
    if (tool.poses()[i]) samples.push_back({frame, tool.times_s()[i], *tool.poses()[i] * tip_in_tool_mm});
  }
  return samples;
}

Eigen::Vector3d mean_place(const std::vector<Sample>& samples, std::size_t first, std::size_t end) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < end; ++i) sum += samples[i].tip;
  return sum / static_cast<double>(end - first);
}

/// From the mean place just before to that just after: the noise of single poses counts less.
std::vector<double> speeds(const std::vector<Sample>& samples, double window_s) {
  std::vector<double> result;
  std::size_t first = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    while (samples[first].time_s < samples[i].time_s - window_s) ++first;
    while (end < samples.size() && samples[end].time_s <= samples[i].time_s + window_s) ++end;
    const std::size_t from = first == i ? i : first;
    if (end - from < 2) {
      result.push_back(kLeastSpeed_mm_s);
      continue;
    }
    const std::size_t middle = std::clamp(i, from + 1, end - 1);
    const auto mean_time = [&](std::size_t a, std::size_t b) {
      double sum = 0.0;
      for (std::size_t k = a; k < b; ++k) sum += samples[k].time_s;
      return sum / static_cast<double>(b - a);
    };
    const double duration = mean_time(middle, end) - mean_time(from, middle);
    const double moved = (mean_place(samples, middle, end) - mean_place(samples, from, middle)).norm();
    result.push_back(std::max(kLeastSpeed_mm_s, moved / duration));
  }
  return result;
}

/// Otsu's threshold: the one with the largest variance between the classes. Empty where they are hardly apart.
std::optional<double> dividing_speed(std::vector<double> speed) {
  std::sort(speed.begin(), speed.end());
  std::vector<double> sums{0.0};
  for (const double value : speed) sums.push_back(sums.back() + std::log(value));
  const auto n = static_cast<double>(speed.size());
  double largest = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 1; i < speed.size(); ++i) {
    const auto slow = static_cast<double>(i);
    const double apart = sums[i] / slow - (sums.back() - sums[i]) / (n - slow);
    const double between = slow * (n - slow) * apart * apart;
    if (between <= largest) continue;
    largest = between;
    at = i;
  }
  if (at == 0) return std::nullopt;
  const double slow = sums[at] / static_cast<double>(at);
  const double fast = (sums.back() - sums[at]) / static_cast<double>(speed.size() - at);
  if (fast - slow < std::log(kSpeedRatio)) return std::nullopt;
  return std::exp(0.5 * (slow + fast));
}

/// Empty where too little is left of the samples [first, end), or the tip moved about.
std::optional<StillPeriod> period_of(const std::vector<Sample>& samples, std::size_t first, std::size_t end,
                                     const StillOptions& options) {
  if (samples[end - 1].time_s - samples[first].time_s < options.min_duration_s) return std::nullopt;
  Eigen::Vector3d centre;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = first; i < end; ++i) values.push_back(samples[i].tip[axis]);
    centre[axis] = median(std::move(values));
  }
  std::vector<double> distances;
  for (std::size_t i = first; i < end; ++i) distances.push_back((samples[i].tip - centre).norm());
  const double farthest = kOutlying * median(distances);
  std::vector<std::size_t> kept;
  for (std::size_t i = first; i < end; ++i) {
    if (distances[i - first] <= farthest) kept.push_back(i);
  }
  Eigen::MatrixXd tips(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i)
    tips.row(static_cast<Eigen::Index>(i)) = samples[kept[i]].tip.transpose();
  StillPeriod period{samples[first].frame, samples[end - 1].frame, tips.colwise().mean(), Eigen::Vector3d::Zero(),
                     static_cast<int>(kept.size())};
  if (kept.size() < 3) return std::nullopt;
  const auto n = static_cast<double>(kept.size());
  tips.rowwise() -= period.place_mm.transpose();
  const Eigen::Vector3d variance = tips.colwise().squaredNorm() / (n - 1.0);
  if (std::sqrt(variance.sum()) > options.max_sd_mm) return std::nullopt;
  period.sd_mm = (variance * correlated_neighbours(tips) / n).cwiseSqrt();
  return period;
}

}  // namespace

void StillOptions::check() const {
  if (!(min_duration_s > 0.0 && window_s > 0.0)) throw Error("still periods: durations must be above 0 s");
  if (!(same_place_mm >= 0.0 && max_sd_mm > 0.0)) throw Error("still periods: distances must be above 0 mm");
}

std::vector<StillPeriod> still_periods(const ProbePoses& tool, const Eigen::Vector3d& tip_in_tool_mm,
                                       const StillOptions& options) {
  options.check();
  const std::vector<Sample> samples = samples_of(tool, tip_in_tool_mm);
  const std::vector<double> speed = speeds(samples, options.window_s);
  const std::optional<double> still_below = dividing_speed(speed);
  if (!still_below) {
    throw Error(tool.recording() + ": the tip does not rest and move in turns; hold it still on each landmark for " +
                std::to_string(static_cast<int>(std::ceil(options.min_duration_s))) + " s or longer");
  }
  std::vector<StillPeriod> periods;
  for (std::size_t first = 0; first < samples.size();) {
    std::size_t end = first;
    while (end < samples.size() && speed[end] < *still_below &&
           (end == first || samples[end].time_s - samples[end - 1].time_s <= kMaxPoseGap_s)) {
      ++end;
    }
    if (end > first) {
      const auto period = period_of(samples, first, end, options);
      const bool known = period && std::any_of(periods.begin(), periods.end(), [&](const StillPeriod& other) {
                           return (other.place_mm - period->place_mm).norm() < options.same_place_mm;
                         });
      if (period && !known) periods.push_back(*period);
    }
    first = std::max(end, first + 1);
  }
  if (periods.empty()) {
    throw Error(tool.recording() + ": the tip rests nowhere for long enough; hold it still on each landmark for " +
                std::to_string(static_cast<int>(std::ceil(options.min_duration_s))) + " s or longer");
  }
  return periods;
}

}  // namespace fathom
