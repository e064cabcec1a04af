#include "measurement/kept_meshes.h"

#include <unordered_map>
#include <utility>

namespace fathom {

namespace {

// Null beyond the ends.
const SampledLayer* layer_at(const MeshedLayers& stack, int k) {
  const bool there = k >= 0 && k < static_cast<int>(stack.layers.size());
  return there ? stack.layers[static_cast<std::size_t>(k)].get() : nullptr;
}

void keep_meshes(const MeshedLayers& before, MeshedLayers& made) {
  std::unordered_map<const SampledLayer*, int> place_before;
  for (std::size_t k = 0; k < before.layers.size(); ++k) {
    place_before.emplace(before.layers[k].get(), static_cast<int>(k));
  }
  made.meshes.assign(made.layers.size(), nullptr);
  for (int k = 0; k < static_cast<int>(made.layers.size()); ++k) {
    const auto place = place_before.find(layer_at(made, k));
    if (place == place_before.end()) continue;
    bool same = true;
    for (int d = -kLayerReach; d <= kLayerReach && same; ++d) {
      same = layer_at(made, k + d) == layer_at(before, place->second + d);
    }
    if (same) made.meshes[static_cast<std::size_t>(k)] = before.meshes[static_cast<std::size_t>(place->second)];
  }
}

}  // namespace

void mesh_changed(const MeshedLayers& before, const MesherOptions& options, MeshedLayers& made,
                  const Progress& progress) {
  keep_meshes(before, made);
  std::vector<const SampledLayer*> stack;
  for (const auto& layer : made.layers) stack.push_back(layer.get());
  MesherOptions mesher = options;
  mesher.cap_ends = true;
  const int count = static_cast<int>(made.layers.size());
  for (int first = 0; first < count;) {
    if (made.meshes[static_cast<std::size_t>(first)]) {
      ++first;
      continue;
    }
    int last = first + 1;
    while (last < count && !made.meshes[static_cast<std::size_t>(last)]) ++last;
    report(progress, static_cast<double>(first) / count);
    std::vector<LayerMesh> meshes = mesh_layers(stack, first, last, mesher);
    for (int k = first; k < last; ++k) {
      made.meshes[static_cast<std::size_t>(k)] =
          std::make_shared<LayerMesh>(std::move(meshes[static_cast<std::size_t>(k - first)]));
    }
    first = last;
  }
}

}  // namespace fathom
