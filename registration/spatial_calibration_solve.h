#pragma once

#include <vector>

#include "registration/spatial_calibration_model.h"

namespace fathom {

/// One minimisation by Ceres from `start`, of the parameters in `fitted`, over the observations that are `used`.
/// `loss_mm` is the scale of Cauchy's loss; 0: plain squares. Never farther than `max_latency_s`.
SpatialState solve_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                           const std::vector<bool>& used, const SpatialState& start, const SpatialMask& fitted,
                           double loss_mm, int iterations, double max_latency_s);

}  // namespace fathom
