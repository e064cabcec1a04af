#pragma once

#include <span>

#include "segmentation/contours.h"
#include "segmentation/edge_map.h"
#include "segmentation/edge_preference.h"

namespace fathom {

/// Where a line begins and ends.
struct WireEnds {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  std::span<const Eigen::Vector2d> before;  ///< the line that leads to `from`, without that; may be empty
  std::span<const Eigen::Vector2d> behind;  ///< and that goes on from `to`
};

/// The line that a path along the points of a lattice stands for: between pixels, where the edge is strongest across
/// it, `preference.beside_px` beside that. It bends as little as the edges allow, by how clear each is, so that it is
/// smooth along speckle and rounds stretches where nothing is seen as the line does on both sides of them. It starts
/// and ends at the seeds, to which the path's ends are near, in the directions of the lines there. `spacing_px` is the
/// lattice's.
Polygon wire_line(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> path,
                  double spacing_px, const WireEnds& ends);

/// How far to the right of the true edge at a point of a line, or left where negative, the map's edges are strongest
/// where the line bends: smoothing moves them to the inside of bends. In pixels.
double smoothed_aside_px(const EdgeMap& map, std::span<const Eigen::Vector2d> line, std::size_t index);

/// The direction of a line at one of its points, over some pixels around; zero where it has none.
Eigen::Vector2d direction_at(std::span<const Eigen::Vector2d> line, std::size_t index);

}  // namespace fathom
