#pragma once

#include <vector>

#include <Eigen/Core>

#include "registration/spatial_calibration_model.h"

namespace fathom {

/// Where a state puts all observations.
struct SpatialErrors {
  std::vector<Eigen::Vector3d> error_mm;
  std::vector<bool> inside;  ///< whether the tracker knew the probe's pose then
};

SpatialErrors spatial_errors(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const SpatialState& state);

/// Standard deviation of one row's error, from the median of those that are `used`.
double row_scale(const std::vector<SpatialObservation>& observations, const SpatialErrors& errors,
                 const std::vector<bool>& used);

/// Which observations to use: neither points nor frames that stand out, nor those without a pose.
std::vector<bool> without_outliers(const std::vector<SpatialObservation>& observations, const SpatialErrors& errors);

/// The frames that have observations in use, ascending.
std::vector<int> frames_of(const std::vector<SpatialObservation>& observations, const std::vector<bool>& used);

}  // namespace fathom
