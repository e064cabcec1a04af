#pragma once

#include <string>
#include <vector>

#include "registration/spatial_calibration.h"

namespace fathom {

/// How much the probe turned about each axis of the image, as standard deviations in degrees, and how far it moved.
struct ProbeMotion {
  Eigen::Vector3d turned_deg = Eigen::Vector3d::Zero();  ///< about image x (tilt), y (twist), normal (rock)
  double moved_mm = 0.0;                                 ///< standard deviation of the probe's place
  double height_mm = 0.0;                                ///< of its place along the phantom's z: over a floor
};

ProbeMotion probe_motion(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state);

/// The advice that ends an error: which movement is missing from those frames.
std::string movement_to_add(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state,
                            CalibrationTarget target);

/// Advice for a probe that lay still.
std::string movement_from_rest(CalibrationTarget target);

}  // namespace fathom
