#pragma once

#include <string>
#include <vector>

#include "registration/spatial_calibration_model.h"

namespace fathom {

/// How much the probe turned about each axis of the image, as standard deviations in degrees, and how far it moved.
struct ProbeMotion {
  Eigen::Vector3d turned_deg = Eigen::Vector3d::Zero();  ///< about image x (tilt), y (twist), normal (rock)
  double moved_mm = 0.0;                                 ///< standard deviation of the probe's place
};

ProbeMotion probe_motion(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state);

/// The advice that ends an error: which movement is missing from those frames.
std::string movement_to_add(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state);

}  // namespace fathom
