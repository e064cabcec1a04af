#pragma once

#include <vector>

#include "registration/spatial_calibration_model.h"

namespace fathom {

/// How far a calibration puts what was seen from where it belongs.
struct TargetErrors {
  int frames = 0;
  double mean_mm = 0.0;      ///< of the smallest 95 % of the distances, as PLUS reports
  double mean_all_mm = 0.0;  ///< of all
  double rms_mm = 0.0;
  double max_mm = 0.0;
};

/// Of at least one distance.
TargetErrors target_errors(std::vector<double> distances_mm, int frames);

/// Distances of observations from where `state`, which holds the phantom's pose too, says that they belong; those
/// without a pose are left out. Throws Error when none is left.
TargetErrors observed_errors(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const SpatialState& state);

double mean_of(const std::vector<double>& values);
double rms_of(const std::vector<double>& values);

}  // namespace fathom
