#include "registration/wall_calibration.h"

#include <utility>

#include "registration/unknown_phantom.h"

namespace fathom {

SpatialOptions wall_options() {
  SpatialOptions options;
  options.target = CalibrationTarget::kWall;
  for (const auto parameter : {kPhantomTz, kPhantomRx, kPhantomRy}) options.phantom[parameter] = true;
  options.min_frames = 24;
  return options;
}

std::vector<SpatialObservation> wall_observations(const std::vector<WallLine>& lines) {
  std::vector<SpatialObservation> observations;
  for (const WallLine& line : lines) {
    for (const double side : {-1.0, 1.0}) {
      SpatialObservation observation;
      observation.frame = line.frame;
      observation.position_px = line.point_px + side * line.reach_px * line.direction;
      observation.rows.row(0) = Eigen::RowVector3d::UnitZ();
      observation.row_count = 1;
      observations.push_back(observation);
    }
  }
  return observations;
}

SpatialFit calibrate_with_wall(const ProbePoses& poses, const std::vector<WallLine>& lines,
                               const SpatialOptions& options) {
  StartSearch search;
  search.phantom_from_reference = plane_turns();
  search.trials = 4;  // neighbouring directions make up for few
  return calibrate_with_unknown_phantom(poses, wall_observations(lines), std::move(search), options);
}

TargetErrors wall_errors(const ProbePoses& poses, const std::vector<WallLine>& lines, const SpatialState& state) {
  return observed_errors(poses, wall_observations(lines), state);
}

}  // namespace fathom
