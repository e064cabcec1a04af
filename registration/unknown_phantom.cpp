#include "registration/unknown_phantom.h"

#include "registration/usable_sweep.h"

namespace fathom {

SpatialFit calibrate_with_unknown_phantom(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                                          StartSearch search, const SpatialOptions& options) {
  options.check();
  require_usable_sweep(poses, observations, options);
  search.latencies_s = latencies_to_try(poses, options);
  search.seed = options.seed;
  SpatialFit fit =
      calibrate_spatial(poses, observations, starts_with_unknown_phantom(poses, observations, search), options);
  require_agreement(poses, fit, options);
  return fit;
}

}  // namespace fathom
