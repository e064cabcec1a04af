#include "registration/target_errors.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/error.h"
#include "registration/spatial_calibration_errors.h"

namespace fathom {

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms_of(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

TargetErrors target_errors(std::vector<double> distances_mm, int frames) {
  assert(!distances_mm.empty());
  std::sort(distances_mm.begin(), distances_mm.end());
  TargetErrors errors;
  errors.frames = frames;
  errors.mean_all_mm = mean_of(distances_mm);
  errors.rms_mm = rms_of(distances_mm);
  errors.max_mm = distances_mm.back();
  constexpr double kPlusShare = 0.95;
  distances_mm.resize(static_cast<std::size_t>(std::ceil(kPlusShare * static_cast<double>(distances_mm.size()))));
  errors.mean_mm = mean_of(distances_mm);
  return errors;
}

TargetErrors observed_errors(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const SpatialState& state) {
  const SpatialErrors errors = spatial_errors(poses, observations, state);
  std::vector<double> distances;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (errors.inside[i]) distances.push_back(errors.error_mm[i].norm());
  }
  if (distances.empty()) throw Error(poses.recording() + ": no frame that shows the phantom has a pose; record again");
  return target_errors(std::move(distances), static_cast<int>(frames_of(observations, errors.inside).size()));
}

}  // namespace fathom
