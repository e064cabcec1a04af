#pragma once

#include <span>

#include "segmentation/contours.h"
#include "segmentation/edge_map.h"
#include "segmentation/edge_preference.h"

namespace fathom {

/// The line that a path along the points of a lattice stands for: between pixels, where the edge is strongest across
/// it, `preference.beside_px` beside that, without the path's stairs. It starts and ends at the seeds, to which the
/// path's ends are near. `spacing_px` is the lattice's.
Polygon wire_line(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> path,
                  double spacing_px, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

/// The direction of a line at one of its points, over some pixels around; zero where it has none.
Eigen::Vector2d direction_at(std::span<const Eigen::Vector2d> line, std::size_t index);

}  // namespace fathom
