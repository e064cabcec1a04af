#include "surface/mesh_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"
#include "surface/mesh_check.h"

namespace fathom {

namespace {

// Of the mesh's size: how far the boundary may lie from a plane that cuts it.
constexpr double kOffPlane = 1e-6;

// Sine of the angle between two planes below which they count as parallel: their common line has no sure direction.
constexpr double kParallel = 1e-6;

/// A sum whose rounding does not grow with the number of terms (Neumaier's).
class CompensatedSum {
 public:
  void add(double value) {
    const double sum = sum_ + value;
    rest_ += std::abs(sum_) >= std::abs(value) ? (sum_ - sum) + value : (value - sum) + sum_;
    sum_ = sum;
  }

  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0.0;
  double rest_ = 0.0;
};

class CompensatedVector {
 public:
  void add(const Eigen::Vector3d& vector) {
    for (int i = 0; i < 3; ++i) sums_[static_cast<std::size_t>(i)].add(vector[i]);
  }

  Eigen::Vector3d value() const { return {sums_[0].value(), sums_[1].value(), sums_[2].value()}; }

 private:
  std::array<CompensatedSum, 3> sums_;
};

// Differences from here keep the digits that coordinates far from the origin would take.
Eigen::Vector3d centre_of_vertices(const Mesh& mesh) {
  CompensatedVector sum;
  for (const Eigen::Vector3d& vertex : mesh.vertices) sum.add(vertex);
  return sum.value() / static_cast<double>(mesh.vertices.size());
}

std::array<Eigen::Vector3d, 3> corners_about(const Mesh& mesh, std::size_t t, const Eigen::Vector3d& origin) {
  const auto at = [&](std::size_t k) -> Eigen::Vector3d {
    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])] - origin;
  };
  return {at(0), at(1), at(2)};
}

double sweep_sign(const Mesh& mesh, std::size_t t) { return mesh.sweep_signs.empty() ? 1.0 : mesh.sweep_signs[t]; }

std::string counted(int count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

void require_sides(const MeshTopology& topology) {
  if (topology.triangles == 0) throw Error("the surface has no triangles: no volume");
  if (topology.non_manifold_edges > 0) {
    throw Error("the surface branches at " + counted(topology.non_manifold_edges, "edge", "edges") +
                " with more than two triangles: no volume; separate the parts");
  }
  if (topology.non_manifold_vertices > 0) {
    throw Error("the surface is pinched at " + counted(topology.non_manifold_vertices, "vertex", "vertices") +
                ": no volume; separate the parts that touch there");
  }
  if (topology.inconsistent_edges > 0) {
    throw Error("the surface is turned inside out in places (" + counted(topology.inconsistent_edges, "edge", "edges") +
                " between triangles that face opposite ways): no volume; orient the triangles alike");
  }
}

void require_no_boundary(const MeshTopology& topology) {
  if (!topology.closed()) {
    throw Error("the surface is open (" + counted(topology.boundary_edges, "boundary edge", "boundary edges") +
                "): no volume; close the holes");
  }
}

void require_enclosed_volume(const Mesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  require_sides(topology);
  require_no_boundary(topology);
}

// Six times the volumes of the tetrahedra from `origin` to the triangles, and the sum of these times their centroids.
struct Moments {
  CompensatedSum sixfold_mm3;
  CompensatedVector first_mm4;
};

Moments moments(const Mesh& mesh, const Eigen::Vector3d& origin) {
  Moments sums;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners_about(mesh, t, origin);
    const double sixfold = sweep_sign(mesh, t) * a.cross(b).dot(c);
    sums.sixfold_mm3.add(sixfold);
    sums.first_mm4.add(sixfold / 4.0 * (a + b + c));
  }
  return sums;
}

using Edge = std::pair<std::int32_t, std::int32_t>;

// Edges of one triangle.
std::vector<Edge> boundary(const Mesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax({triangle[k], triangle[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> open;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool again = i + 1 < edges.size() && edges[i + 1] == edges[i];
    if (!again && (i == 0 || edges[i - 1] != edges[i])) open.push_back(edges[i]);
  }
  return open;
}

// For each edge, a number that it has in common with the edges of the same loop. A manifold's boundary is made of
// loops, so every vertex has two edges.
std::vector<std::size_t> loops_of(const std::vector<Edge>& edges) {
  std::map<std::int32_t, std::vector<std::size_t>> at_vertex;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    at_vertex[edges[i].first].push_back(i);
    at_vertex[edges[i].second].push_back(i);
  }
  std::vector<std::size_t> loops(edges.size(), edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    std::vector<std::size_t> open = {i};
    while (!open.empty()) {
      const std::size_t edge = open.back();
      open.pop_back();
      if (loops[edge] != edges.size()) continue;
      loops[edge] = i;
      for (const std::int32_t vertex : {edges[edge].first, edges[edge].second}) {
        open.insert(open.end(), at_vertex[vertex].begin(), at_vertex[vertex].end());
      }
    }
  }
  return loops;
}

// Every loop of the boundary must run in one plane normal to each of `normals`, or partly in the one and partly in the
// other. Closing it within these planes adds faces that are not seen along both, so that they add no volume.
void require_cut_by_planes(const Mesh& mesh, const std::vector<Eigen::Vector3d>& normals,
                           const Eigen::Vector3d& direction, const Eigen::Vector3d& origin) {
  const std::vector<Edge> edges = boundary(mesh);
  const std::vector<std::size_t> loops = loops_of(edges);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  const double tolerance = kOffPlane * box.sizes().norm();
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
  };
  std::map<std::pair<std::size_t, std::size_t>, Range> offsets;  // by loop and normal
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Eigen::Vector3d from = mesh.vertices[static_cast<std::size_t>(edges[i].first)] - origin;
    const Eigen::Vector3d to = mesh.vertices[static_cast<std::size_t>(edges[i].second)] - origin;
    // An edge along the direction of projection lies in both planes, and may lie anywhere.
    if ((to - from).cross(direction).norm() <= kOffPlane * (to - from).norm()) continue;
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < normals.size(); ++k) {
      if (std::abs(normals[k].dot(to - from)) < std::abs(normals[nearest].dot(to - from))) nearest = k;
    }
    Range& range = offsets[{loops[i], nearest}];
    for (const Eigen::Vector3d& end : {from, to}) {
      range.low = std::min(range.low, normals[nearest].dot(end));
      range.high = std::max(range.high, normals[nearest].dot(end));
    }
    if (range.high - range.low > tolerance) {
      throw Error(
          "the surface has an open edge that does not lie in a plane that cuts it: no volume; close the holes "
          "or name the plane");
    }
  }
}

// Treece 2000, equation (B.10), but any direction in the plane where there is one only: as printed the direction
// vanishes for a normal along (1, 1, 1).
Eigen::Vector3d projection(const std::vector<Eigen::Vector3d>& normals) {
  if (normals.empty()) return Eigen::Vector3d::UnitZ();
  if (normals.size() == 2) {
    const Eigen::Vector3d common = normals[0].cross(normals[1]);
    if (common.norm() > kParallel) return common.normalized();
  }
  return normals[0].unitOrthogonal();
}

}  // namespace

double area_mm2(const Mesh& mesh) {
  CompensatedSum sum;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners_about(mesh, t, Eigen::Vector3d::Zero());
    sum.add(0.5 * (b - a).cross(c - a).norm());
  }
  return sum.value();
}

double volume_mm3(const Mesh& mesh) {
  require_enclosed_volume(mesh);
  return moments(mesh, centre_of_vertices(mesh)).sixfold_mm3.value() / 6.0;
}

Eigen::Vector3d centroid_mm(const Mesh& mesh) {
  require_enclosed_volume(mesh);
  const Eigen::Vector3d origin = centre_of_vertices(mesh);
  const Moments sums = moments(mesh, origin);
  const double sixfold = sums.sixfold_mm3.value();
  if (sixfold == 0.0) throw Error("the surface encloses no volume, which has no centroid");
  return origin + sums.first_mm4.value() / sixfold;
}

double projected_volume_mm3(const Mesh& mesh, std::span<const Eigen::Vector3d> plane_normals) {
  if (plane_normals.size() > 2) {
    throw Error("the surface is cut by " + std::to_string(plane_normals.size()) +
                " planes: the volume is known between no more than two; close the surface");
  }
  std::vector<Eigen::Vector3d> normals;
  for (const Eigen::Vector3d& normal : plane_normals) {
    normals.push_back(normal.stableNormalized());
    if (!normals.back().allFinite() || normals.back().isZero()) {
      throw Error("a plane that cuts the surface has no normal; give one of finite length");
    }
  }
  const MeshTopology topology = mesh_topology(mesh);
  require_sides(topology);
  if (plane_normals.empty()) require_no_boundary(topology);
  const Eigen::Vector3d direction = projection(normals);
  const Eigen::Vector3d origin = centre_of_vertices(mesh);
  if (!topology.closed()) require_cut_by_planes(mesh, normals, direction, origin);

  CompensatedSum sixfold;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners_about(mesh, t, origin);
    sixfold.add(sweep_sign(mesh, t) * (b - a).cross(c - a).dot(direction) * (a + b + c).dot(direction));
  }
  return sixfold.value() / 6.0;
}

}  // namespace fathom
