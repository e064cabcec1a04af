#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "registration/calibration.h"
#include "registration/pose_chain.h"

namespace fathom {

/// Where every pixel of a recording is: the one place where poses, calibration and latency come together.
class FrameLocator {
 public:
  /// `names` go before the calibration's own. Throws Error when the recording has no chain of transforms from the
  /// probe to the reference, when the calibration was made for another image size, when a pose is not rigid, or when
  /// a latency is to be applied and the frames' time stamps are missing or do not increase.
  FrameLocator(const Recording& recording, const Calibration& calibration, const FrameNames& names = {});

  /// Maps pixels of `frame` (z = 0) to millimetres in reference coordinates. Empty where a pose that it needs is
  /// missing or invalid, or, with a latency, where the shifted time lies outside the valid poses around it.
  /// `frame` is in [0, frame_count).
  std::optional<Eigen::Affine3d> reference_from_image(int frame) const;

  const std::string& probe_frame() const { return probe_frame_; }
  const std::string& reference_frame() const { return reference_frame_; }
  const std::string& recording_name() const { return recording_name_; }
  int frame_count() const { return static_cast<int>(reference_from_probe_.size()); }

 private:
  std::string recording_name_;
  std::string probe_frame_;
  std::string reference_frame_;
  Eigen::Affine3d probe_from_image_;
  std::vector<std::optional<Eigen::Isometry3d>> reference_from_probe_;  ///< latency applied
};

}  // namespace fathom
