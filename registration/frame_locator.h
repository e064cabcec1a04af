#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "registration/calibration.h"

namespace fathom {

/// Names of the coordinates to work in, where the user chose them; else the calibration's, else "Probe" and
/// "Reference" (where the recording has it, else "Tracker").
struct FrameNames {
  std::optional<std::string> probe;
  std::optional<std::string> reference;
};

/// Where every pixel of a recording is: the one place where poses, calibration and latency come together.
class FrameLocator {
 public:
  /// Throws Error when the recording has no chain of transforms from the probe to the reference, or when the
  /// calibration was made for another image size.
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
