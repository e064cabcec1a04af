#pragma once

#include <vector>

#include "registration/spatial_calibration.h"
#include "registration/target_errors.h"
#include "registration/wall_detection.h"

namespace fathom {

/// Options for a flat floor: more frames are needed than with wires, for each gives two numbers only.
SpatialOptions wall_options();

/// Calibrates from the line that a flat floor makes in each frame; the floor's own attitude and height are estimated
/// with the calibration: z = 0 of `SpatialState::reference_from_phantom` is the floor, seen from any side.
/// A line counts as two places, a standard deviation of its columns to both sides of their middle: these have
/// independent errors and tell all that the columns tell.
/// What determines what: moving nearer and farther the depth's scale; rocking the image's lateral place and scale;
/// tilting its elevational place; twisting by a quarter turn or more its rotation against the floor's slope.
/// Throws Error when there are too few frames, the motion is too poor, or the lines are not those of one floor.
/// Prager 1998, Ultrasound in Med. & Biol. 24, 855, for the unknowns; the start is found without a guess.
SpatialFit calibrate_with_wall(const ProbePoses& poses, const std::vector<WallLine>& lines,
                               const SpatialOptions& options = wall_options());

/// Distances of both places of each line from the floor. Throws Error when no frame has a pose.
TargetErrors wall_errors(const ProbePoses& poses, const std::vector<WallLine>& lines, const SpatialState& state);

/// What the solver gets: two observations a line.
std::vector<SpatialObservation> wall_observations(const std::vector<WallLine>& lines);

}  // namespace fathom
