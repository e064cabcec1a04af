#pragma once

#include <vector>

#include "registration/spatial_calibration.h"

namespace fathom {

/// Sets the covariance of a fit, its rms and the worst standard deviation of a pixel seen. Throws Error, naming the
/// movement to add, where the motion does not determine the parameters, or not as well as the options ask.
void set_covariance(const ProbePoses& poses, const std::vector<SpatialObservation>& observations, SpatialFit& fit,
                    const SpatialOptions& options);

}  // namespace fathom
