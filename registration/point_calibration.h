#pragma once

#include <vector>

#include "registration/spatial_calibration.h"
#include "registration/target_errors.h"
#include "registration/wall_detection.h"

namespace fathom {

/// Options for a single point.
SpatialOptions point_options();

/// Calibrates from a small target (a bead, crossed wires) seen in each frame; its place in space is estimated with the
/// calibration: the origin of `SpatialState::reference_from_phantom`. It must be seen in all parts of the image and
/// from several sides. Throws Error when there are too few frames, the motion is too poor, or what was seen is not one
/// point.
SpatialFit calibrate_with_point(const ProbePoses& poses, const std::vector<SpotPoint>& points,
                                const SpatialOptions& options = point_options());

/// Distances from the point. Throws Error when no frame has a pose.
TargetErrors point_errors(const ProbePoses& poses, const std::vector<SpotPoint>& points, const SpatialState& state);

/// What the solver gets: one observation a frame.
std::vector<SpatialObservation> point_observations(const std::vector<SpotPoint>& points);

}  // namespace fathom
