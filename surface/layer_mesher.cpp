#include "surface/layer_mesher.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include <opencv2/core/utility.hpp>

#include "surface/cube_mesh.h"
#include "surface/tetrahedra_mesh.h"

namespace fathom {

namespace {

// The stack with what closes it: layers from -1 to its size where the ends are capped.
class Stack {
 public:
  Stack(std::span<const SampledLayer* const> layers, bool cap_ends)
      : layers_(layers), size_(static_cast<int>(layers.size())) {
    if (!cap_ends) return;
    ends_ = {outside(*layers.front()), outside(*layers.back())};
  }

  int low() const { return ends_.empty() ? 0 : -1; }
  int high() const { return ends_.empty() ? size_ : size_ + 1; }
  bool beyond(int k) const { return k < 0 || k >= size_; }
  const SampledLayer* at(int k) const {
    if (k < low() || k >= high()) return nullptr;
    if (beyond(k)) return &ends_[k < 0 ? 0 : 1];
    return layers_[static_cast<std::size_t>(k)];
  }

 private:
  static SampledLayer outside(SampledLayer layer) {
    std::fill(layer.values.begin(), layer.values.end(), kFarOutside);
    return layer;
  }

  std::span<const SampledLayer* const> layers_;
  int size_;
  std::vector<SampledLayer> ends_;
};

template <typename Work>
void for_each_layer(int begin, int end, const Work& work) {
  cv::parallel_for_(cv::Range(begin, end), [&work](const cv::Range& range) {
    for (int k = range.start; k < range.end; ++k) work(k);
  });
}

// The layers of a stack around those that are being meshed, by their numbers; null outside of the stack.
class CutLayers {
 public:
  CutLayers(const Stack& stack, int window) : stack_(stack), layers_(static_cast<std::size_t>(window)) {}

  /// Valid for the last `window` of the layers that were begun.
  CutLayer* at(int k) {
    if (k < stack_.low() || k >= stack_.high()) return nullptr;
    return &layers_[static_cast<std::size_t>(k - stack_.low()) % layers_.size()];
  }

  void begin(int k) {
    CutLayer& layer = *at(k);
    layer.samples = stack_.at(k);
    layer.parity = k & 1;
    layer.beyond = stack_.beyond(k);
    mark_inside(layer);
  }

 private:
  const Stack& stack_;
  std::vector<CutLayer> layers_;
};

// Layers that are cut and meshed at a time: enough for all threads, and few enough to stay in the cache.
constexpr int kLayersAtATime = 32;

std::vector<LayerMesh> mesh_tetrahedra(const Stack& stack, int first, int last, const MesherOptions& options) {
  const Clustering clustering = options.mesher == Mesher::kRegularised ? Clustering::kClusters : Clustering::kNone;
  std::vector<LayerMesh> meshes(static_cast<std::size_t>(last - first));
  // The vertices of a layer depend on the cuts of its neighbours, and these on the samples of theirs. The made-up layer
  // below the stack has no vertices; its triangles go to the first layer.
  CutLayers layers(stack, std::min(last - first, kLayersAtATime) + 5);
  int begun = std::max(stack.low(), first - 2);
  int cut = std::max(stack.low(), first - 1);
  for (int start = first; start < last; start += kLayersAtATime) {
    const int end = std::min(last, start + kLayersAtATime);
    const int begin_to = std::min(stack.high(), end + 2);
    for_each_layer(begun, begin_to, [&](int k) { layers.begin(k); });
    begun = begin_to;
    const int cut_to = std::min(stack.high(), end + 1);
    for_each_layer(cut, cut_to,
                   [&](int k) { mark_cuts(*layers.at(k), layers.at(k - 1), layers.at(k + 1), clustering); });
    cut = cut_to;
    for_each_layer(start, end, [&](int k) {
      LayerMesh& mesh = meshes[static_cast<std::size_t>(k - first)];
      const auto vertices = static_cast<std::size_t>(layers.at(k)->vertices);
      mesh.vertices.reserve(vertices);
      mesh.normals.reserve(vertices);
      mesh.triangles.reserve(5 * vertices / 2);  // about two for each vertex of a closed surface
      if (k == 0 && stack.low() < 0) add_triangles(*layers.at(-1), *layers.at(0), mesh);
      add_vertices({{layers.at(k - 1), layers.at(k), layers.at(k + 1)}}, options.placement, mesh);
      if (layers.at(k + 1)) add_triangles(*layers.at(k), *layers.at(k + 1), mesh);
    });
  }
  return meshes;
}

std::vector<LayerMesh> mesh_cubes(const Stack& stack, int first, int last) {
  const auto mesh_layer = [&stack](int k) {
    return cube_layer({{stack.at(k - 1), stack.at(k), stack.at(k + 1), stack.at(k + 2)}},
                      {{stack.beyond(k - 1), stack.beyond(k), stack.beyond(k + 1), stack.beyond(k + 2)}});
  };
  std::vector<LayerMesh> meshes(static_cast<std::size_t>(last - first));
  for_each_layer(first, last, [&](int k) {
    LayerMesh mesh = mesh_layer(k);
    if (k == 0 && stack.low() < 0) {
      // What belongs to the made-up layer below comes first.
      LayerMesh both = mesh_layer(-1);
      const auto shift = static_cast<std::int32_t>(both.vertices.size());
      both.vertices.insert(both.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
      both.normals.insert(both.normals.end(), mesh.normals.begin(), mesh.normals.end());
      for (const Mesh::Triangle& t : mesh.triangles) {
        both.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
      }
      mesh = std::move(both);
    }
    meshes[static_cast<std::size_t>(k - first)] = std::move(mesh);
  });
  return meshes;
}

}  // namespace

std::vector<LayerMesh> mesh_layers(std::span<const SampledLayer* const> stack, int first, int last,
                                   const MesherOptions& options) {
  assert(0 <= first && first <= last && last <= static_cast<int>(stack.size()));
  assert(stack.size() >= 2);
  if (first == last) return {};
  const Stack closed(stack, options.cap_ends);
  if (options.mesher == Mesher::kCubes) return mesh_cubes(closed, first, last);
  return mesh_tetrahedra(closed, first, last, options);
}

}  // namespace fathom
