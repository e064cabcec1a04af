#include "registration/temporal_signals.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/error.h"
#include "core/statistics.h"

namespace fathom {

namespace {

// A hand turns round in half a second: over a tenth to both sides its way is a parabola to a hundredth.
constexpr double kLeastReach_s = 0.1;
constexpr double kReachInSamples = 3.5;  // a parabola through fewer would follow the noise
constexpr std::size_t kLeastSamples = 5;
constexpr std::size_t kLeastBeside = 1;  // samples on either side
constexpr double kGapInSamples = 5.0;

bool earlier(const TimedValue& value, double time) { return value.time_s < time; }

}  // namespace

Signal floor_signal(const Recording& recording, const std::vector<WallLine>& floor) {
  Signal signal{recording.name(), {}};
  const double middle = 0.5 * (recording.header().width - 1);
  for (const WallLine& line : floor) {
    const auto& time = recording.header().frames.at(static_cast<std::size_t>(line.frame)).time_s;
    if (!time || (!signal.values.empty() && *time <= signal.values.back().time_s)) continue;
    const double slope = line.direction.y() / line.direction.x();
    signal.values.push_back({*time, line.point_px.y() + slope * (middle - line.point_px.x())});
  }
  if (signal.values.empty()) {
    throw Error(recording.name() + ": no frame that shows a floor has a time stamp; record with time stamps");
  }
  return signal;
}

Signal motion_signal(const ProbePoses& poses) {
  if (!poses.has_times()) {
    throw Error(poses.recording() +
                ": time stamps are missing or do not increase, so no latency can be found; record with time stamps");
  }
  if (poses.valid_count() < 2) {
    throw Error(poses.recording() + ": has fewer than two valid poses; record again within the tracker's range");
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& pose : poses.poses()) {
    if (pose) mean += pose->translation() / poses.valid_count();
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& pose : poses.poses()) {
    if (pose) spread += (pose->translation() - mean) * (pose->translation() - mean).transpose();
  }
  const Eigen::Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  Signal signal{poses.recording(), {}};
  for (std::size_t i = 0; i < poses.poses().size(); ++i) {
    const auto& pose = poses.poses()[i];
    if (pose) signal.values.push_back({poses.times_s()[i], axis.dot(pose->translation() - mean)});
  }
  return signal;
}

double spread(const Signal& signal) {
  const auto n = static_cast<double>(signal.values.size());
  if (n < 2.0) return 0.0;
  double mean = 0.0;
  for (const TimedValue& value : signal.values) mean += value.value / n;
  double squares = 0.0;
  for (const TimedValue& value : signal.values) squares += (value.value - mean) * (value.value - mean);
  return std::sqrt(squares / n);
}

SmoothSignal::SmoothSignal(Signal signal) : signal_(std::move(signal)) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < signal_.values.size(); ++i) {
    steps.push_back(signal_.values[i].time_s - signal_.values[i - 1].time_s);
  }
  const double step = median(std::move(steps));
  reach_s_ = std::max(kLeastReach_s, kReachInSamples * step);
  max_gap_s_ = std::min(kMaxPoseGap_s, kGapInSamples * step);
  std::vector<double> distances;  // as if of single samples: their own weights pull the curve
  for (std::size_t i = 0; i < signal_.values.size(); ++i) {
    const auto here = at(signal_.values[i].time_s);
    smoothed_.push_back(here ? std::optional(here->value) : std::nullopt);
    if (!here) continue;
    double share = 1.0;
    for (const auto& [index, weight] : weights_at(signal_.values[i].time_s)) {
      share += weight * weight - (index == i ? 2.0 * weight : 0.0);
    }
    distances.push_back((signal_.values[i].value - here->value) / std::sqrt(share));
  }
  double squares = 0.0;
  for (const double distance : distances) squares += distance * distance;
  if (!distances.empty()) noise_ = std::sqrt(squares / static_cast<double>(distances.size()));
}

bool SmoothSignal::is_gap(std::size_t before) const {
  return signal_.values[before + 1].time_s - signal_.values[before].time_s > max_gap_s_;
}

// Weighted least squares of value = c0 + c1 x + c2 x^2, x the time from here over the reach.
struct SmoothSignal::Window {
  std::size_t first = 0;
  std::vector<Eigen::Vector3d> weighted_powers;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
};

std::optional<SmoothSignal::Window> SmoothSignal::window_at(double time_s) const {
  const auto& values = signal_.values;
  const auto after = std::lower_bound(values.begin(), values.end(), time_s, earlier);
  if (after == values.end() || time_s < values.front().time_s) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - values.begin());
  if (i > 0 && is_gap(i - 1)) return std::nullopt;
  Window window;
  window.first = static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), time_s - reach_s_, earlier) -
                                          values.begin());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (std::size_t k = window.first; k < values.size() && values[k].time_s < time_s + reach_s_; ++k) {
    const double x = (values[k].time_s - time_s) / reach_s_;
    const double hat = 1.0 - x * x;
    const Eigen::Vector3d powers(1.0, x, x * x);
    window.weighted_powers.emplace_back(hat * hat * hat * powers);
    normal += window.weighted_powers.back() * powers.transpose();
  }
  // One-sided fits at the ends of a recording would be noisier than the others.
  const std::size_t behind = window.first + window.weighted_powers.size() - i;
  if (window.weighted_powers.size() < kLeastSamples || i < window.first + kLeastBeside || behind < kLeastBeside) {
    return std::nullopt;
  }
  window.inverse = normal.inverse();
  if (!window.inverse.allFinite()) return std::nullopt;
  return window;
}

std::optional<SmoothSignal::At> SmoothSignal::at(double time_s) const {
  const auto window = window_at(time_s);
  if (!window) return std::nullopt;
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < window->weighted_powers.size(); ++k) {
    right += signal_.values[window->first + k].value * window->weighted_powers[k];
  }
  const Eigen::Vector3d fit = window->inverse * right;
  return At{fit[0], fit[1] / reach_s_};
}

std::vector<std::pair<std::size_t, double>> SmoothSignal::weights_at(double time_s) const {
  std::vector<std::pair<std::size_t, double>> weights;
  const auto window = window_at(time_s);
  if (!window) return weights;
  for (std::size_t k = 0; k < window->weighted_powers.size(); ++k) {
    weights.emplace_back(window->first + k, window->inverse.row(0).dot(window->weighted_powers[k]));
  }
  return weights;
}

std::optional<double> SmoothSignal::roughly_at(double time_s) const {
  const auto& values = signal_.values;
  const auto after = std::lower_bound(values.begin(), values.end(), time_s, earlier);
  if (after == values.end() || after == values.begin()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - values.begin());
  if (is_gap(i - 1) || !smoothed_[i - 1] || !smoothed_[i]) return std::nullopt;
  const double part = (time_s - values[i - 1].time_s) / (values[i].time_s - values[i - 1].time_s);
  return (1.0 - part) * *smoothed_[i - 1] + part * *smoothed_[i];
}

}  // namespace fathom
