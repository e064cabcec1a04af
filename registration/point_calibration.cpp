#include "registration/point_calibration.h"

#include "registration/calibration_start.h"
#include "registration/usable_sweep.h"

namespace fathom {

SpatialOptions point_options() {
  SpatialOptions options;
  options.target = CalibrationTarget::kPoint;
  for (const auto parameter : {kPhantomTx, kPhantomTy, kPhantomTz}) options.phantom[parameter] = true;
  options.min_frames = 20;
  return options;
}

std::vector<SpatialObservation> point_observations(const std::vector<SpotPoint>& points) {
  std::vector<SpatialObservation> observations;
  for (const SpotPoint& point : points) {
    SpatialObservation observation;
    observation.frame = point.frame;
    observation.position_px = point.position_px;
    observation.rows = Eigen::Matrix3d::Identity();
    observation.row_count = 3;
    observations.push_back(observation);
  }
  return observations;
}

SpatialFit calibrate_with_point(const ProbePoses& poses, const std::vector<SpotPoint>& points,
                                const SpatialOptions& options) {
  options.check();
  const auto observations = point_observations(points);
  require_usable_sweep(poses, observations, options);
  StartSearch search;
  search.phantom_from_reference = {Eigen::Matrix3d::Identity()};  // a point looks the same from all sides
  search.latencies_s = latencies_to_try(poses, options);
  search.trials = 100;
  search.seed = options.seed;
  SpatialFit fit =
      calibrate_spatial(poses, observations, starts_with_unknown_phantom(poses, observations, search), options);
  require_agreement(poses, fit, options);
  return fit;
}

TargetErrors point_errors(const ProbePoses& poses, const std::vector<SpotPoint>& points, const SpatialState& state) {
  return observed_errors(poses, point_observations(points), state);
}

}  // namespace fathom
