#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace fathom {

/// A triangle mesh in millimetres.
struct Mesh {
  /// Indices of vertices, counter-clockwise where the triangle is seen from outside.
  using Triangle = std::array<std::int32_t, 3>;

  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
  /// Unit vectors that point outward, one for each vertex; or empty.
  std::vector<Eigen::Vector3d> normals;
  /// +1, or -1 for a triangle in a region that the sweep passed backward, which counts negative in volumes; one for
  /// each triangle, or empty where all are +1. Treece 2000, sections 3.2.6 and 3.4.2.
  std::vector<std::int8_t> sweep_signs;
};

}  // namespace fathom
