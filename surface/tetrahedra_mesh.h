#pragma once

#include "surface/cut_layer.h"
#include "surface/layer_geometry.h"
#include "surface/layer_mesh.h"
#include "surface/layer_mesher.h"

namespace fathom {

/// A cut is no nearer to a sample than this share of its edge, so that no triangle is without area.
inline constexpr float kLeastCut = 1e-3F;

/// The layers around a layer that its vertices depend on, their cuts marked; null where there are none.
struct LayerStar {
  std::array<const CutLayer*, 3> layers{};

  const CutLayer* at(int step) const { return layers[static_cast<std::size_t>(step + 1)]; }
};

/// Appends the vertices near the samples of the middle layer, with normals. Treece 2000, sections 3.4.4 and 3.4.5.
void add_vertices(const LayerStar& around, VertexPlacement placement, LayerMesh& mesh);

/// Appends the triangles between a layer and the next, `above`.
void add_triangles(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh);

/// Appends the triangles that close the surface between a layer and the next at their flat sides.
void add_side_caps(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh);

}  // namespace fathom
