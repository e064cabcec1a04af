#include "registration/wall_calibration.h"

#include "registration/calibration_start.h"
#include "registration/usable_sweep.h"

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
  options.check();
  const auto observations = wall_observations(lines);
  require_usable_sweep(poses, observations, options);
  StartSearch search;
  search.phantom_from_reference = plane_turns();
  search.latencies_s = latencies_to_try(poses, options);
  search.trials = 4;  // neighbouring directions make up for few
  search.seed = options.seed;
  SpatialFit fit =
      calibrate_spatial(poses, observations, starts_with_unknown_phantom(poses, observations, search), options);
  require_agreement(poses, fit, options);
  return fit;
}

TargetErrors wall_errors(const ProbePoses& poses, const std::vector<WallLine>& lines, const SpatialState& state) {
  return observed_errors(poses, wall_observations(lines), state);
}

}  // namespace fathom
