#include "surface/plane_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace fathom {

namespace {

// Of the largest coordinate: the rounding of a distance from a plane.
constexpr double kTouching = 16 * std::numeric_limits<double>::epsilon();

void settle_touching(const Mesh& mesh, PlaneSides& sides) {
  std::vector<std::size_t> at_plane;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool touches = std::any_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::int32_t v) {
      return sides.distances_mm[static_cast<std::size_t>(v)] == 0.0;
    });
    if (touches) at_plane.push_back(t);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::size_t t : at_plane) {
      const auto is_positive = [&](std::int32_t v) { return sides.positive[static_cast<std::size_t>(v)] != 0; };
      if (std::none_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), is_positive)) continue;
      for (const std::int32_t v : mesh.triangles[t]) {
        if (is_positive(v) || sides.distances_mm[static_cast<std::size_t>(v)] != 0.0) continue;
        sides.positive[static_cast<std::size_t>(v)] = 1;
        changed = true;
      }
    }
  }
}

}  // namespace

PlaneSides plane_sides(const Mesh& mesh, const Eigen::Hyperplane<double, 3>& plane) {
  PlaneSides sides;
  double reach = std::abs(plane.offset());
  for (const Eigen::Vector3d& vertex : mesh.vertices) reach = std::max(reach, vertex.lpNorm<Eigen::Infinity>());
  sides.distances_mm.reserve(mesh.vertices.size());
  sides.positive.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    double distance = plane.signedDistance(vertex);
    if (std::abs(distance) <= kTouching * reach) {
      distance = 0.0;
      sides.any_touching = true;
    }
    sides.distances_mm.push_back(distance);
    sides.positive.push_back(distance > 0.0 ? 1 : 0);
  }
  if (sides.any_touching) settle_touching(mesh, sides);
  return sides;
}

}  // namespace fathom
