#include "registration/tracker_jitter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/live/still_gate.h"
#include "acquisition/rigid.h"

namespace fathom {

namespace {

constexpr double kJitterWindow_s = 0.5;
constexpr int kFewSamples = 5;  // of a window: fewer say nothing
constexpr double kStill_mm_s = 3.0;
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// Poses of a still probe, half a second of them.
class JitterWindow {
 public:
  // Sums of squares about a steady drift, each over as many samples less two.
  struct Sums {
    double position_mm2 = 0.0;
    double angle_rad2 = 0.0;
    int freedom = 0;
    double still_s = 0.0;
  };

  bool empty() const { return places_.empty(); }
  double start_s() const { return start_s_; }

  void add(double time_s, const Eigen::Isometry3d& pose) {
    if (places_.empty()) {
      start_s_ = time_s;
      first_ = pose;
    }
    times_s_.push_back(time_s - start_s_);
    places_.push_back(pose.translation());
    const Eigen::AngleAxisd turn(first_.linear().transpose() * pose.linear());
    turns_.push_back(turn.angle() * turn.axis());
  }

  void finish(Sums& sums) {
    if (static_cast<int>(places_.size()) >= kFewSamples) {
      const Drift place = drift_of(places_);
      // A slow sweep is no stillness.
      if (place.speed <= kStill_mm_s) {
        sums.position_mm2 += place.residual;
        sums.angle_rad2 += drift_of(turns_).residual;
        sums.freedom += static_cast<int>(places_.size()) - 2;
        sums.still_s += times_s_.back();
      }
    }
    times_s_.clear();
    places_.clear();
    turns_.clear();
  }

 private:
  struct Drift {
    double speed = 0.0;
    double residual = 0.0;  ///< sum of squares
  };

  // The straight line through values over time, by least squares.
  Drift drift_of(const std::vector<Eigen::Vector3d>& values) const {
    const auto count = static_cast<double>(values.size());
    double mean_s = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < values.size(); ++i) {
      mean_s += times_s_[i] / count;
      mean += values[i] / count;
    }
    double of_times = 0.0;
    double of_values = 0.0;
    Eigen::Vector3d of_both = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < values.size(); ++i) {
      of_times += (times_s_[i] - mean_s) * (times_s_[i] - mean_s);
      of_values += (values[i] - mean).squaredNorm();
      of_both += (times_s_[i] - mean_s) * (values[i] - mean);
    }
    return {of_both.norm() / of_times, std::max(0.0, of_values - of_both.squaredNorm() / of_times)};
  }

  double start_s_ = 0.0;
  Eigen::Isometry3d first_ = Eigen::Isometry3d::Identity();
  std::vector<double> times_s_;  // since the first
  std::vector<Eigen::Vector3d> places_;
  std::vector<Eigen::Vector3d> turns_;
};

}  // namespace

std::optional<TrackerJitter> tracker_jitter(std::span<const TrackerSample> samples) {
  // Wider than what is found too much: an unsteady tracker must not pass for a moving hand.
  StillDetector detector({.duration_s = kJitterWindow_s, .radius_mm = 5.0, .angle_deg = 5.0});
  JitterWindow window;
  JitterWindow::Sums sums;
  for (const TrackerSample& sample : samples) {
    const bool usable = sample.pose.valid() && is_rigid(sample.pose.matrix);
    const auto pose = usable ? std::optional(nearest_rigid(sample.pose.matrix)) : std::nullopt;
    const bool still = detector.add(sample.time_s, pose);
    if (!window.empty() && (!still || sample.time_s - window.start_s() >= kJitterWindow_s)) window.finish(sums);
    if (still) window.add(sample.time_s, *pose);
  }
  window.finish(sums);
  if (sums.freedom == 0) return std::nullopt;
  return TrackerJitter{std::sqrt(sums.position_mm2 / sums.freedom),
                       std::sqrt(sums.angle_rad2 / sums.freedom) * kDegreesPerRadian, sums.still_s};
}

}  // namespace fathom
