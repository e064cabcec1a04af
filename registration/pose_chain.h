#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"

namespace fathom {

/// A hand turns round in about this time: between poses farther apart, a straight way would be a guess.
inline constexpr double kMaxPoseGap_s = 0.5;

/// Names of the coordinates to work in, where the user or the calibration chose them; else "Probe" and "Reference"
/// (where the recording has it, else "Tracker").
struct FrameNames {
  std::optional<std::string> probe;
  std::optional<std::string> reference;
};

/// How to get from the probe to the reference by the transforms that a recording stores.
struct PoseChain {
  struct Step {
    std::size_t transform = 0;  ///< index into RecordingHeader::transforms
    bool inverted = false;
  };
  std::string probe;
  std::string reference;
  std::vector<Step> steps;  ///< from the probe's side on
};

/// "ProbeToTracker" -> {"Probe", "Tracker"}; empty where the name does not read so.
std::optional<std::pair<std::string, std::string>> split_transform_name(const std::string& name);

/// The shortest chain, inverses allowed, transforms of the image (pixels, no motion) left out. Throws Error, listing
/// what the recording has, when there is none.
PoseChain find_pose_chain(const Recording& recording, const FrameNames& names);

/// The chain to look at when nothing was chosen: as find_pose_chain, else the transform that the recording itself
/// declares to be its default ("DefaultFrameTransformName"). Empty where there is neither.
std::optional<PoseChain> default_pose_chain(const Recording& recording, const FrameNames& names);

/// Pose of the probe in reference coordinates (mm), made orthonormal; empty where a pose on the way is missing or
/// marked invalid. Throws Error when one is not rigid to 1e-3.
std::optional<Eigen::Isometry3d> reference_from_probe(const Recording& recording, const PoseChain& chain, int frame);

}  // namespace fathom
