#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "registration/spatial_calibration.h"

namespace fathom {

/// Where a calibration can start from without a guess, the phantom's pose being known: for every latency in
/// `latencies_s` the linear map from pixels to the probe is solved from a few frames at a time, and the map that most
/// frames agree with is kept (half of the frames may be wrong). The best comes first, one a latency. Empty where no
/// frame with a pose has observations that determine a map.
std::vector<SpatialState> starts_with_known_phantom(const ProbePoses& poses,
                                                    const std::vector<SpatialObservation>& observations,
                                                    const Eigen::Isometry3d& reference_from_phantom,
                                                    const std::vector<double>& latencies_s, std::uint64_t seed);

/// How to look for a start where the phantom's pose is not known.
struct StartSearch {
  std::vector<Eigen::Matrix3d> phantom_from_reference;  ///< rotations of the phantom tried
  std::vector<double> latencies_s = {0.0};
  std::size_t count = 8;  ///< starts wanted
  int trials = 0;         ///< for each rotation, of `frames_a_trial` frames beside one of all: withstand wrong frames
  int frames_a_trial = 8;
  std::uint64_t seed = 1;
};

/// For every rotation and latency the phantom's translation is solved together with the linear map; where a phantom
/// looks the same shifted along an axis, that shift stays near 0. At most `count` starts, best first.
std::vector<SpatialState> starts_with_unknown_phantom(const ProbePoses& poses,
                                                      const std::vector<SpatialObservation>& observations,
                                                      const StartSearch& search);

/// Rotations about 25 degrees apart that cover all.
std::vector<Eigen::Matrix3d> all_turns();

/// Rotations that turn directions about 8 degrees apart, one of each opposite pair, to z: all attitudes of a plane.
std::vector<Eigen::Matrix3d> plane_turns();

/// 0, then both signs of every 0.05 s up to `max_latency_s`: a hand at 30 mm/s moves 1.5 mm meanwhile, near enough.
/// 0 alone where no latency is to be fitted.
std::vector<double> latencies_to_try(const ProbePoses& poses, const SpatialOptions& options);

}  // namespace fathom
