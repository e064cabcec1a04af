#pragma once

#include <deque>
#include <optional>

#include "acquisition/live/live_source.h"

namespace fathom {

/// The way between two rigid poses at `share` of the time from one to the other: straight, and evenly turning (slerp).
/// Matrices of pixels ("ImageToProbe"), which are not rigid, are interpolated number by number.
Eigen::Matrix4d interpolated(const Eigen::Matrix4d& from, const Eigen::Matrix4d& to, double share);

/// When a pose is asked for.
struct PoseMoment {
  double time_s = 0.0;
  std::optional<double> device_time_s;  ///< set where the samples have stamps of the same device's clock
};

/// The samples of one transform, and its pose at any time between them.
class PoseInterpolator {
 public:
  explicit PoseInterpolator(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// Samples must come in the order of their times. Returns false for one that is not later than the last: it is not
  /// used. What is older than ten seconds is forgotten.
  bool add(const TrackerSample& sample);

  /// Whether a sample of that moment or behind it has come: waiting longer changes nothing.
  bool reaches(const PoseMoment& moment) const;

  /// The pose, or the identity with a status that says why there is none: that of an invalid neighbour, or "MISSING"
  /// where there is no neighbour or they are too far apart.
  Pose at(const PoseMoment& moment) const;

  const TrackerSample* last() const { return samples_.empty() ? nullptr : &samples_.back(); }

 private:
  const TrackerSample* of_device_time(const PoseMoment& moment) const;

  double max_gap_s_;
  std::deque<TrackerSample> samples_;
};

}  // namespace fathom
