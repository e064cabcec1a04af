#include "registration/temporal_calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/error.h"
#include "core/numbers.h"
#include "core/statistics.h"
#include "registration/temporal_start.h"

namespace fathom {

namespace {

constexpr double kOutlying = 6.0;  // of the median distance, 4 standard deviations
constexpr double kLeastPx = 1e-6;  // perfect data must not divide by nothing
constexpr int kRounds = 30;
constexpr double kSettled_s = 1e-7;

/// Least squares of depth(t) = scale place(t + latency) + offset over the frames that are `used`.
struct Fit {
  Eigen::Vector3d scale_offset_latency = Eigen::Vector3d::Zero();
  std::vector<TimedValue> errors;  ///< px, one for each frame; not finite where the tracker does not tell
  std::vector<Eigen::Vector3d> gradients;
};

void evaluate(const Signal& image, const SmoothSignal& tracker, Fit& fit) {
  fit.errors.clear();
  fit.gradients.clear();
  const Eigen::Vector3d& p = fit.scale_offset_latency;
  for (const TimedValue& value : image.values) {
    const auto place = tracker.at(value.time_s + p[2]);
    const double expected = place ? p[0] * place->value + p[1] : std::nan("");
    fit.errors.push_back({value.time_s, value.value - expected});
    fit.gradients.emplace_back(place ? Eigen::Vector3d(place->value, 1.0, p[0] * place->slope)
                                     : Eigen::Vector3d::Zero());
  }
}

std::vector<bool> without_outliers(const Fit& fit) {
  std::vector<double> sizes;
  for (const TimedValue& error : fit.errors) {
    if (std::isfinite(error.value)) sizes.push_back(std::abs(error.value));
  }
  const double farthest = std::max(kLeastPx, kOutlying * median(std::move(sizes)));
  std::vector<bool> used;
  for (const TimedValue& error : fit.errors) used.push_back(std::abs(error.value) <= farthest);
  return used;
}

Eigen::Matrix3d normal_matrix(const Fit& fit, const std::vector<bool>& used) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) normal += fit.gradients[i] * fit.gradients[i].transpose();
  }
  return normal;
}

/// A step of Gauss and Newton, the latency by no more than a step of the search. Returns how far the latency moved.
double improve(Fit& fit, const std::vector<bool>& used, bool latency) {
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) right += fit.gradients[i] * fit.errors[i].value;
  }
  Eigen::Matrix3d normal = normal_matrix(fit, used);
  if (!latency) {
    normal.row(2).setZero();
    normal.col(2).setZero();
    normal(2, 2) = 1.0;
    right[2] = 0.0;
  }
  Eigen::Vector3d step = normal.ldlt().solve(right);
  step[2] = std::clamp(step[2], -2.0 * kLatencyStep_s, 2.0 * kLatencyStep_s);
  fit.scale_offset_latency += step;
  return std::abs(step[2]);
}

/// Mean products of errors that are so many frames' times apart: the variance first, up to the last that is beyond
/// chance.
std::vector<double> covariance_by_lag(const std::vector<TimedValue>& errors, double frame_s) {
  constexpr std::size_t kMostLags = 250;  // ten seconds of images; what lasts longer is offset
  const std::size_t lags = std::min(kMostLags, errors.size() / 4);
  std::vector<double> products(lags, 0.0);
  std::vector<double> pairs(lags, 0.0);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    for (std::size_t k = i; k < errors.size(); ++k) {
      const auto lag = static_cast<std::size_t>(std::lround((errors[k].time_s - errors[i].time_s) / frame_s));
      if (lag >= lags) break;
      products[lag] += errors[i].value * errors[k].value;
      pairs[lag] += 1.0;
    }
  }
  std::vector<double> covariance;
  for (std::size_t lag = 0; lag < lags; ++lag) {
    const double mean = pairs[lag] > 0.0 ? products[lag] / pairs[lag] : 0.0;
    constexpr double kChance = 2.0;  // standard deviations
    if (lag > 0 && mean * std::sqrt(pairs[lag]) < kChance * covariance[0]) break;
    covariance.push_back(mean);
  }
  return covariance;
}

/// Variance of the latency when errors that follow each other hang together as they are seen to do. `pulls` is by how
/// much the latency follows an error of each frame.
double variance_together(const std::vector<TimedValue>& errors, const std::vector<TimedValue>& pulls) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < errors.size(); ++i) steps.push_back(errors[i].time_s - errors[i - 1].time_s);
  const double frame_s = median(std::move(steps));
  const std::vector<double> covariance = covariance_by_lag(errors, frame_s);
  double variance = 0.0;
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    for (std::size_t k = i; k < pulls.size(); ++k) {
      const auto lag = static_cast<std::size_t>(std::lround((pulls[k].time_s - pulls[i].time_s) / frame_s));
      if (lag >= covariance.size()) break;
      variance += (k == i ? 1.0 : 2.0) * pulls[i].value * pulls[k].value * covariance[lag];
    }
  }
  return variance;
}

/// The same from independent noise of the tracker's samples, which the smoothing spreads over neighbouring frames, and
/// of the image's frames: what is left of the errors. `pulls` is by how much the latency follows an error of each
/// frame.
double variance_independent(const SmoothSignal& tracker, const Fit& fit, const std::vector<TimedValue>& pulls,
                            double error_variance) {
  const double scale = fit.scale_offset_latency[0];
  const double tracker_variance = scale * scale * tracker.noise() * tracker.noise();
  std::vector<double> pull_of_sample(tracker.sample_count(), 0.0);
  double pulls_squared = 0.0;
  double smoothed = 0.0;  // what of a sample's variance is left in the curve, on average
  for (const TimedValue& pull : pulls) {
    pulls_squared += pull.value * pull.value;
    for (const auto& [index, weight] : tracker.weights_at(pull.time_s + fit.scale_offset_latency[2])) {
      pull_of_sample[index] += pull.value * weight;
      smoothed += weight * weight / static_cast<double>(pulls.size());
    }
  }
  double samples_squared = 0.0;
  for (const double pull : pull_of_sample) samples_squared += pull * pull;
  const double image_variance = std::max(0.0, error_variance - smoothed * tracker_variance);
  return image_variance * pulls_squared + tracker_variance * samples_squared;
}

void set_quality(const Signal& image, const SmoothSignal& tracker, const Fit& fit, const std::vector<bool>& used,
                 TemporalCalibration& result) {
  const Eigen::Matrix3d inverse = normal_matrix(fit, used).inverse();
  std::vector<TimedValue> pulls;
  std::vector<TimedValue> errors;
  double squares = 0.0;
  Signal kept;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const double error = fit.errors[i].value;
    squares += error * error;
    pulls.push_back({fit.errors[i].time_s, inverse.row(2).dot(fit.gradients[i])});
    errors.push_back(fit.errors[i]);
    kept.values.push_back(image.values[i]);
  }
  const auto n = static_cast<double>(errors.size());
  constexpr double kParameters = 3.0;
  result.rms_px = std::sqrt(squares / n);
  const double independent = variance_independent(tracker, fit, pulls, squares / (n - kParameters));
  const double together = variance_together(errors, pulls) * n / (n - kParameters);
  result.stddev_s = std::sqrt(std::max(independent, together));
  result.correlation = std::sqrt(std::max(0.0, 1.0 - squares / (n * spread(kept) * spread(kept))));
}

/// Improves the fit until its latency stays. Returns which frames it is of; none where it does not settle.
std::vector<bool> settle(const Signal& image, const SmoothSignal& tracker, Fit& fit) {
  constexpr int kChoosing = 10;  // rounds; afterwards frames at the limit would come and go for ever
  std::vector<bool> used;
  bool settled = false;
  for (int round = 0; round < kRounds && !settled; ++round) {
    evaluate(image, tracker, fit);
    if (round < kChoosing) used = without_outliers(fit);
    for (std::size_t i = 0; i < used.size(); ++i) used[i] = used[i] && std::isfinite(fit.errors[i].value);
    settled = improve(fit, used, true) < kSettled_s;
  }
  evaluate(image, tracker, fit);
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = used[i] && std::isfinite(fit.errors[i].value);
  return settled ? used : std::vector<bool>();
}

void require_motion(const Signal& image, const Signal& tracker, const TemporalOptions& options) {
  if (spread(tracker) < options.min_motion_mm) {
    throw Error(tracker.source + ": the probe did not move (standard deviation " + format_rounded(spread(tracker), 1) +
                " mm); move it up and down while recording");
  }
  if (spread(image) < options.min_motion_px) {
    throw Error(image.source + ": the floor does not move in the image (standard deviation " +
                format_rounded(spread(image), 1) + " pixels); move the probe up and down over a flat floor");
  }
}

}  // namespace

void TemporalOptions::check() const {
  if (!(max_latency_s >= 2.0 * kLatencyStep_s && max_latency_s <= 10.0)) {
    throw Error("temporal calibration: the largest latency must be 0.01 to 10 s");
  }
  if (min_frames < 10) throw Error("temporal calibration: at least 10 frames are needed");
  if (!(min_correlation > 0.0 && min_correlation < 1.0)) {
    throw Error("temporal calibration: the correlation must be between 0 and 1");
  }
  if (!(min_motion_mm > 0.0 && min_motion_px > 0.0 && max_stddev_s > 0.0)) {
    throw Error("temporal calibration: limits must be above 0");
  }
}

TemporalCalibration find_latency(const Signal& image, const Signal& tracker, const TemporalOptions& options) {
  options.check();
  const Signal calm = without_spikes(image);
  require_motion(calm, tracker, options);
  const std::string both = image.source == tracker.source ? image.source : image.source + " and " + tracker.source;
  const SmoothSignal smooth(tracker);
  Fit fit;
  fit.scale_offset_latency[2] = latency_start(calm, smooth, options, both);
  // Scale and offset for the start's latency first.
  evaluate(calm, smooth, fit);
  improve(fit, without_outliers(fit), false);
  const std::vector<bool> used = settle(image, smooth, fit);
  TemporalCalibration result;
  result.frames_seen = static_cast<int>(image.values.size());
  result.frames_used = static_cast<int>(std::count(used.begin(), used.end(), true));
  result.latency_s = fit.scale_offset_latency[2];
  result.px_per_mm = fit.scale_offset_latency[0];
  const bool enough = result.frames_used >= options.min_frames;
  if (enough) set_quality(image, smooth, fit, used, result);
  if (!enough || !(result.stddev_s <= options.max_stddev_s)) {
    throw Error(both + ": the motion does not tell the latency" +
                (result.stddev_s > 0.0 ? " (only to " + format_rounded(1e3 * result.stddev_s, 0) + " ms)" : "") +
                "; move the probe up and down, faster and for longer");
  }
  if (!(result.correlation >= options.min_correlation)) {
    throw Error(both +
                ": the floor's depth does not follow the probe; move the probe straight up and down over a flat "
                "floor");
  }
  return result;
}

}  // namespace fathom
