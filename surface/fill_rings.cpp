#include "surface/fill_rings.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "surface/ear_clipping.h"

namespace fathom {

namespace {

using Step = std::pair<std::int32_t, std::int32_t>;

bool encloses(const FlatPolygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i].at;
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()].at;
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

struct FlatRing {
  FlatPolygon polygon;
  double area = 0.0;
  std::size_t depth = 0;                // how many others enclose it
  std::vector<std::size_t> holes;       // of one that is no hole
  std::optional<std::size_t> around{};  // the smallest that encloses it
};

std::vector<FlatRing> flattened(const std::vector<Ring>& rings, const Eigen::Vector3d& normal,
                                const std::vector<Eigen::Vector3d>& vertices) {
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d up = normal.normalized().cross(across);
  const Eigen::Vector3d origin = vertices[static_cast<std::size_t>(rings.front().front())];
  std::vector<FlatRing> flat(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i) {
    for (const std::int32_t vertex : rings[i]) {
      const Eigen::Vector3d from_origin = vertices[static_cast<std::size_t>(vertex)] - origin;
      flat[i].polygon.push_back({vertex, {across.dot(from_origin), up.dot(from_origin)}});
    }
    flat[i].area = signed_area(flat[i].polygon);
  }
  return flat;
}

// Gives holes to the rings around them. A hole runs the other way; one that does not lies in a surface that overlaps
// itself and is filled on its own.
void nest(std::vector<FlatRing>& rings) {
  for (FlatRing& ring : rings) {
    for (std::size_t k = 0; k < rings.size(); ++k) {
      if (&rings[k] == &ring || !encloses(rings[k].polygon, ring.polygon.front().at)) continue;
      ++ring.depth;
      if (!ring.around || std::abs(rings[k].area) < std::abs(rings[*ring.around].area)) ring.around = k;
    }
  }
  // Where rings cross, one may lie in a hole at the depth of a hole.
  const auto is_hole = [&rings](const FlatRing& ring) {
    return ring.depth % 2 == 1 && rings[*ring.around].depth % 2 == 0 &&
           (ring.area > 0.0) != (rings[*ring.around].area > 0.0);
  };
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (is_hole(rings[i])) {
      rings[*rings[i].around].holes.push_back(i);
    } else {
      rings[i].around.reset();
    }
  }
}

// Every step of the rings once, every other edge once either way.
bool fills(const std::vector<Mesh::Triangle>& triangles, const std::vector<const FlatPolygon*>& rings) {
  std::vector<Step> steps;
  for (const Mesh::Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) steps.emplace_back(triangle[k], triangle[(k + 1) % 3]);
  }
  // The rings' steps turned round make the surface closed.
  for (const FlatPolygon* ring : rings) {
    for (std::size_t i = 0; i < ring->size(); ++i) {
      steps.emplace_back((*ring)[(i + 1) % ring->size()].vertex, (*ring)[i].vertex);
    }
  }
  std::sort(steps.begin(), steps.end());
  if (std::adjacent_find(steps.begin(), steps.end()) != steps.end()) return false;
  std::vector<Step> back;
  back.reserve(steps.size());
  for (const auto& [a, b] : steps) {
    if (a == b) return false;
    back.emplace_back(b, a);
  }
  std::sort(back.begin(), back.end());
  return back == steps;
}

// Mirrored if need be, so that it is counter-clockwise; its order stays, and with it the way that triangles face.
FlatPolygon turned(FlatPolygon polygon, bool mirror) {
  for (FlatCorner& corner : polygon) {
    if (mirror) corner.at.y() = -corner.at.y();
  }
  return polygon;
}

std::optional<std::vector<Mesh::Triangle>> triangulated(const std::vector<FlatRing>& rings, const FlatRing& outer) {
  const bool mirror = outer.area < 0.0;
  std::vector<const FlatPolygon*> parts{&outer.polygon};
  std::vector<FlatPolygon> holes;
  for (const std::size_t hole : outer.holes) {
    parts.push_back(&rings[hole].polygon);
    holes.push_back(turned(rings[hole].polygon, mirror));
  }
  for (const FlatPolygon* part : parts) {
    if (part->size() < 3) return {};
  }
  const auto polygon = bridge_holes(turned(outer.polygon, mirror), std::move(holes));
  if (!polygon) return {};
  std::vector<Mesh::Triangle> triangles = clip_ears(*polygon);
  if (!fills(triangles, parts)) return {};
  return triangles;
}

void add_fan(const FlatPolygon& ring, std::vector<Eigen::Vector3d>& vertices, std::vector<Mesh::Triangle>& triangles) {
  const auto middle = static_cast<std::int32_t>(vertices.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const FlatCorner& corner : ring) sum += vertices[static_cast<std::size_t>(corner.vertex)];
  vertices.emplace_back(sum / static_cast<double>(ring.size()));
  for (std::size_t i = 0; i < ring.size(); ++i) {
    triangles.push_back({middle, ring[i].vertex, ring[(i + 1) % ring.size()].vertex});
  }
}

}  // namespace

std::vector<Mesh::Triangle> fill_rings(const std::vector<Ring>& rings, const Eigen::Vector3d& normal,
                                       std::vector<Eigen::Vector3d>& vertices) {
  std::vector<Mesh::Triangle> triangles;
  if (rings.empty()) return triangles;
  std::vector<FlatRing> flat = flattened(rings, normal, vertices);
  nest(flat);
  for (const FlatRing& ring : flat) {
    if (ring.around) continue;
    if (const auto made = triangulated(flat, ring)) {
      triangles.insert(triangles.end(), made->begin(), made->end());
      continue;
    }
    add_fan(ring.polygon, vertices, triangles);
    for (const std::size_t hole : ring.holes) add_fan(flat[hole].polygon, vertices, triangles);
  }
  return triangles;
}

}  // namespace fathom
