#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// A unit vector for each vertex: the mean of the normals of its triangles, weighted by their areas. Zero for a vertex
/// whose triangles have no area between them, or that has none. `mesh` must be valid (see require_valid).
std::vector<Eigen::Vector3d> vertex_normals(const Mesh& mesh);

}  // namespace fathom
