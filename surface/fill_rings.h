#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// Vertices by index, in order; the last is joined to the first.
using Ring = std::vector<std::int32_t>;

/// Triangles that fill what rings in a plane enclose, by even-odd: an odd ring within another is a hole. Every step of
/// a ring is passed once, in its direction, by a triangle, and every other edge twice, once either way: so where the
/// rings bound a manifold mesh, the triangles close it, however near to each other the points lie. A ring that runs
/// counter-clockwise as seen against `normal` gets triangles that face along `normal`.
///
/// Rings have at least two vertices and none has a vertex of another. `vertices` are those that the rings name. Where
/// rings cross or touch, so that no triangulation by their own points is found, each ring is filled by a fan about a
/// new vertex in its middle, which is appended: the triangles then overlap, but have the right vector area.
std::vector<Mesh::Triangle> fill_rings(const std::vector<Ring>& rings, const Eigen::Vector3d& normal,
                                       std::vector<Eigen::Vector3d>& vertices);

}  // namespace fathom
