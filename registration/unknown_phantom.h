#pragma once

#include <vector>

#include "registration/calibration_start.h"
#include "registration/probe_poses.h"
#include "registration/spatial_calibration.h"

namespace fathom {

/// Calibrates by a target whose place nobody knows: `search` says which of its turns are tried, and how hard; latencies
/// and seed come from `options`. Throws Error as require_usable_sweep, calibrate_spatial and require_agreement.
SpatialFit calibrate_with_unknown_phantom(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                                          StartSearch search, const SpatialOptions& options);

}  // namespace fathom
