#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// A corner of a polygon in a plane: its vertex, and where it lies.
struct FlatCorner {
  std::int32_t vertex = 0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

/// Counter-clockwise, holes clockwise.
using FlatPolygon = std::vector<FlatCorner>;

/// Twice the area to the left of the way from `a` over `b` to `c`.
inline double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Positive where the polygon is counter-clockwise.
double signed_area(const FlatPolygon& polygon);

/// One polygon without holes: each hole is joined by a bridge, to and fro, from its rightmost corner to a corner that
/// it sees. Empty where one sees none, as rings cross.
std::optional<FlatPolygon> bridge_holes(FlatPolygon outer, std::vector<FlatPolygon> holes);

/// Cuts off ears, the best shaped first, until one triangle is left: two triangles fewer than corners. Where there is
/// no true ear, as the polygon touches itself, one is cut off all the same.
std::vector<Mesh::Triangle> clip_ears(const FlatPolygon& polygon);

}  // namespace fathom
