#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "registration/spatial_calibration_model.h"

namespace fathom {

/// Where a calibration can start from without a guess, the phantom's pose being known: for every latency in
/// `latencies_s` the linear map from pixels to the probe is solved from a few frames at a time, and the map that most
/// frames agree with is kept (half of the frames may be wrong). The best comes first, one a latency. Empty where no
/// frame with a pose has observations that determine a map.
std::vector<SpatialState> starts_with_known_phantom(const ProbePoses& poses,
                                                    const std::vector<SpatialObservation>& observations,
                                                    const Eigen::Isometry3d& reference_from_phantom,
                                                    const std::vector<double>& latencies_s, std::uint64_t seed);

/// The same where the phantom's pose is not known: its rotation is searched over all of space, its translation solved
/// with the map. At most `count` starts, best first, at latency 0.
std::vector<SpatialState> starts_with_unknown_phantom(const ProbePoses& poses,
                                                      const std::vector<SpatialObservation>& observations,
                                                      std::size_t count);

}  // namespace fathom
