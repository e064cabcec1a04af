#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "surface/mesh.h"

namespace fathom {

/// Pairs of triangles, the lower index first, that have a point in common besides the vertices and the edges that they
/// share by index. So a pair counts
/// - that shares no vertex and touches or crosses;
/// - that shares one vertex and meets also away from it;
/// - that shares an edge and lies folded flat onto itself, or shares all three vertices.
/// Decided exactly for the coordinates as they are stored. Triangles without area, which have no plane, are passed
/// over. In ascending order; the search ends once `limit` pairs are found, which then need not be the first ones.
/// `mesh` must be valid.
std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(const Mesh& mesh, std::size_t limit = SIZE_MAX);

}  // namespace fathom
