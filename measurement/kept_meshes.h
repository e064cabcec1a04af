#pragma once

#include <memory>
#include <vector>

#include "core/progress.h"
#include "surface/layer_mesher.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// A stack of layers and their meshes, one for each.
struct MeshedLayers {
  std::vector<std::shared_ptr<const SampledLayer>> layers;
  std::vector<std::shared_ptr<const LayerMesh>> meshes;
};

/// Meshes `made.layers`, capped at both ends; a layer's mesh is that of `before` where all layers that it depends on
/// are the same objects. Throws Cancelled.
void mesh_changed(const MeshedLayers& before, const MesherOptions& options, MeshedLayers& made,
                  const Progress& progress);

}  // namespace fathom
