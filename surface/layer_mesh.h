#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// The part of a surface that belongs to one layer of samples: its vertices, and the triangles between this layer and
/// the next.
struct LayerMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;  ///< unit, outward; one for each vertex
  /// Indices into `vertices`; those from `vertices.size()` on count through the vertices of the next layer.
  std::vector<Mesh::Triangle> triangles;

  bool operator==(const LayerMesh&) const = default;
};

/// Appends the layer that follows the one that was appended last.
/// Throws Error when there are more vertices than a 32-bit index can name.
void append(const LayerMesh& layer, Mesh& mesh);

/// One mesh of successive layers; the last one's triangles refer to no next layer.
/// Throws Error when there are more vertices than a 32-bit index can name.
Mesh join(std::span<const LayerMesh* const> layers);
Mesh join(std::span<const LayerMesh> layers);

}  // namespace fathom
