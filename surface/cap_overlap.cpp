#include "surface/cap_overlap.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "surface/convex_clip.h"

namespace fathom {

namespace {

struct CapTriangle {
  Polygon3 corners;  // counter-clockwise as seen against the normal
  Eigen::AlignedBox3d box;
};

std::vector<CapTriangle> cap_triangles(const ClippedMesh& part, int plane, const Eigen::Vector3d& normal) {
  std::vector<CapTriangle> triangles;
  for (std::size_t t = 0; t < part.plane_of.size(); ++t) {
    if (part.plane_of[t] != plane) continue;
    CapTriangle triangle;
    for (const std::int32_t v : part.mesh.triangles[t]) {
      triangle.corners.push_back(part.mesh.vertices[static_cast<std::size_t>(v)]);
      triangle.box.extend(triangle.corners.back());
    }
    if (vector_area(triangle.corners).dot(normal) < 0.0) std::swap(triangle.corners[1], triangle.corners[2]);
    triangles.push_back(std::move(triangle));
  }
  return triangles;
}

double common_area(const CapTriangle& a, const CapTriangle& b, const Eigen::Vector3d& normal) {
  std::vector<Eigen::Hyperplane<double, 3>> sides;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d inward = normal.cross(b.corners[(k + 1) % 3] - b.corners[k]);
    if (inward.isZero(0.0)) return 0.0;
    sides.emplace_back(inward.normalized(), b.corners[k]);
  }
  return std::max(0.0, vector_area(clip_polygon(a.corners, sides)).dot(normal));
}

}  // namespace

double cap_overlap_mm2(const ClippedMesh& a, int plane_a, const ClippedMesh& b, int plane_b,
                       const Eigen::Vector3d& normal) {
  const std::vector<CapTriangle> first = cap_triangles(a, plane_a, normal);
  std::vector<CapTriangle> second = cap_triangles(b, plane_b, normal);
  // Along the axis on which the cap is longest only near ones are looked at.
  Eigen::AlignedBox3d box;
  for (const CapTriangle& triangle : second) box.extend(triangle.box);
  Eigen::Index axis = 0;
  if (!box.isEmpty()) box.sizes().maxCoeff(&axis);
  std::sort(second.begin(), second.end(), [axis](const CapTriangle& left, const CapTriangle& right) {
    return left.box.min()[axis] < right.box.min()[axis];
  });
  double area = 0.0;
  for (const CapTriangle& triangle : first) {
    for (const CapTriangle& other : second) {
      if (other.box.min()[axis] > triangle.box.max()[axis]) break;
      if (other.box.intersects(triangle.box)) area += common_area(triangle, other, normal);
    }
  }
  return area;
}

}  // namespace fathom
