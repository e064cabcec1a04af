#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "registration/pose_chain.h"

namespace fathom {

/// What a calibration needs of a recording's tracker: where the probe was, at every frame and between them.
class ProbePoses {
 public:
  /// `reference_from_probe` has one pose a frame, empty where the tracker lost the probe; `times_s` one stamp a frame,
  /// or is empty where there are none (no latency can be found then). `recording` is for messages.
  ProbePoses(std::string recording, std::vector<std::optional<Eigen::Isometry3d>> reference_from_probe,
             std::vector<double> times_s);

  /// The probe in the reference at a time, and how fast it moves there.
  struct At {
    Eigen::Isometry3d reference_from_probe = Eigen::Isometry3d::Identity();
    Eigen::Vector3d velocity_mm_s = Eigen::Vector3d::Zero();  ///< of the probe's origin, in reference axes
    Eigen::Vector3d turning_rad_s = Eigen::Vector3d::Zero();  ///< in probe axes
    bool inside = true;  ///< false where the time is not between two valid poses close to each other: extrapolated
  };

  /// The tracker's pose at the stamp of `frame` plus `latency_s`; straight and evenly turning between samples.
  /// Empty where the recording has no valid pose to start from. `frame` is in [0, frame_count).
  std::optional<At> at(int frame, double latency_s) const;

  /// The same poses as means of two moments, a third of the usual frame's time before and after. Between samples a
  /// straight way averages the tracker's noise of both, so that a fit of the latency is drawn to the middle between
  /// samples, where residuals are smallest; of these means the noise is the same everywhere, to 6 % of its variance.
  ProbePoses evenly_smoothed() const;

  const std::string& recording() const { return recording_; }
  int frame_count() const { return static_cast<int>(poses_.size()); }
  int valid_count() const;
  bool has_times() const { return !times_s_.empty(); }
  const std::vector<double>& times_s() const { return times_s_; }
  const std::vector<std::optional<Eigen::Isometry3d>>& poses() const { return poses_; }

 private:
  std::string recording_;
  std::vector<std::optional<Eigen::Isometry3d>> poses_;
  std::vector<double> times_s_;
  /// Between two valid poses that follow each other.
  struct Step {
    double start_s = 0.0;
    double duration_s = 0.0;
    int first = 0;  ///< the frame of its first pose; the next one is its last
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  };
  std::vector<Step> steps_;
  double smoothing_s_ = 0.0;  ///< to both sides

  std::optional<At> straight_at(int frame, double latency_s) const;
};

/// The poses along `chain`. Stamps are left out where one is missing or they do not increase. Throws Error when a pose
/// is not rigid.
ProbePoses probe_poses(const Recording& recording, const PoseChain& chain);

}  // namespace fathom
