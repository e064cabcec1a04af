#include "registration/point_calibration.h"

#include <utility>

#include "registration/unknown_phantom.h"

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
  StartSearch search;
  search.phantom_from_reference = {Eigen::Matrix3d::Identity()};  // a point looks the same from all sides
  search.trials = 100;
  return calibrate_with_unknown_phantom(poses, point_observations(points), std::move(search), options);
}

TargetErrors point_errors(const ProbePoses& poses, const std::vector<SpotPoint>& points, const SpatialState& state) {
  return observed_errors(poses, point_observations(points), state);
}

}  // namespace fathom
