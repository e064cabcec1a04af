#pragma once

#include <vector>

#include "registration/spatial_calibration.h"

namespace fathom {

/// Throws Error, with what to do, where a sweep cannot calibrate whatever is seen in it: too few frames that show the
/// target and have a pose, a probe that the tracker lost for much of the sweep or that did not move, poses in metres.
void require_usable_sweep(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                          const SpatialOptions& options);

/// Throws Error where what was seen does not fit the target: most frames were left out, or the rest agrees badly.
void require_agreement(const ProbePoses& poses, const SpatialFit& fit, const SpatialOptions& options);

}  // namespace fathom
