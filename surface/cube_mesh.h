#pragma once

#include <array>

#include "surface/layer_mesh.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// Marching cubes between two layers of the cubic lattice: the vertices on the edges within the lower one and on those
/// that lead up from it, and the triangles of the cubes between the two.
///
/// On a face with two inside corners across from each other, either cube beside it cuts each of these corners off by
/// itself, so that the surface has no holes (Treece 2000, section 3.3.1, figure 3.17).
///
/// `layers` are the layer below, the layer itself, the next and the one above that; null where there is none. Those
/// that are `beyond` the end of the stack were made up and do not count for normals.
LayerMesh cube_layer(const std::array<const SampledLayer*, 4>& layers, const std::array<bool, 4>& beyond);

}  // namespace fathom
