#include "surface/layer_mesher.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "surface/cube_mesh.h"
#include "surface/tetrahedra_mesh.h"

namespace fathom {

namespace {

// The stack with what closes it: layers from -1 to its size where the ends are capped.
class Stack {
 public:
  Stack(std::span<const SampledLayer* const> layers, const MesherOptions& options)
      : layers_(layers),
        size_(static_cast<int>(layers.size())),
        capped_(options.cap_ends),
        cubes_(options.mesher == Mesher::kCubes) {}

  int low() const { return capped_ ? -1 : 0; }
  int high() const { return capped_ ? size_ + 1 : size_; }
  bool beyond(int k) const { return k < 0 || k >= size_; }

  /// Makes up the layers that close the ends among those from `first` to `last - 1`, of which the ends' own layers are
  /// there.
  void make_ends(int first, int last) {
    if (!capped_) return;
    if (first < 0 && ends_[0].values.empty()) ends_[0] = beyond(layers_[0], layers_[1]);
    if (last > size_ && ends_[1].values.empty()) {
      ends_[1] = beyond(layers_.back(), layers_[layers_.size() - 2]);
    }
  }
  const SampledLayer* at(int k) const {
    if (k < low() || k >= high()) return nullptr;
    if (beyond(k)) return &ends_[k < 0 ? 0 : 1];
    return layers_[static_cast<std::size_t>(k)];
  }

 private:
  // Nearly in the plane of the end, so that the cap is; not quite, so that no two cuts to it and to what closes other
  // sides are at one place. Cubes have no such two.
  SampledLayer beyond(const SampledLayer* end, const SampledLayer* before) const {
    constexpr double kShareOfALayer = 1e-3;
    SampledLayer layer = *end;
    std::fill(layer.values.begin(), layer.values.end(), kFarOutside);
    if (!cubes_) layer.origin += kShareOfALayer * (end->origin - before->origin);
    return layer;
  }

  std::span<const SampledLayer* const> layers_;
  int size_;
  bool capped_;
  bool cubes_;
  std::array<SampledLayer, 2> ends_;
};

template <typename Work>
void for_each_layer(int begin, int end, const Work& work) {
  cv::parallel_for_(cv::Range(begin, end), [&work](const cv::Range& range) {
    for (int k = range.start; k < range.end; ++k) work(k);
  });
}

// Layers that are cut and meshed at a time: enough for all threads, and few enough to stay in the cache.
constexpr int kLayersAtATime = 32;

void clear(LayerMesh& mesh) {
  mesh.vertices.clear();
  mesh.normals.clear();
  mesh.triangles.clear();
}

// Meshes of the body-centred lattice. The vertices of a layer depend on the cuts of its neighbours, and these on the
// samples of theirs.
class TetrahedraLayers {
 public:
  TetrahedraLayers(const Stack& stack, const MesherOptions& options, int first)
      : stack_(stack),
        placement_(options.placement),
        clustering_(options.mesher == Mesher::kRegularised ? Clustering::kClusters : Clustering::kNone),
        cap_sides_(options.cap_sides),
        layers_(kLayersAtATime + 5),
        begun_(std::max(stack.low(), first - 2)),
        cut_(std::max(stack.low(), first - 1)) {}

  // To `meshes` those of layers from `first`, where the last call ended, to `last - 1`; no more than kLayersAtATime.
  void mesh(int first, int last, std::span<LayerMesh> meshes) {
    const int begin_to = std::min(stack_.high(), last + 2);
    for_each_layer(begun_, begin_to, [&](int k) { begin(k); });
    begun_ = begin_to;
    const int cut_to = std::min(stack_.high(), last + 1);
    for_each_layer(cut_, cut_to, [&](int k) { mark_cuts(*at(k), at(k - 1), at(k + 1), clustering_); });
    cut_ = cut_to;
    for_each_layer(first, last, [&](int k) {
      LayerMesh& mesh = meshes[static_cast<std::size_t>(k - first)];
      clear(mesh);
      const auto vertices = static_cast<std::size_t>(at(k)->vertices);
      mesh.vertices.reserve(vertices);
      mesh.normals.reserve(vertices);
      mesh.triangles.reserve(5 * vertices / 2);  // about two for each vertex of a closed surface
      // The made-up layer below the stack has no vertices; its triangles go to the first layer.
      if (k == 0 && stack_.low() < 0) add_between(*at(-1), *at(0), mesh);
      add_vertices({{at(k - 1), at(k), at(k + 1)}}, placement_, mesh);
      if (at(k + 1)) add_between(*at(k), *at(k + 1), mesh);
    });
  }

 private:
  static void add_between(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh) {
    add_triangles(layer, above, mesh);
    if (layer.capped_sides) add_side_caps(layer, above, mesh);
  }

  // Null outside of the stack; valid for the last layers that were begun, as many as there are in `layers_`.
  CutLayer* at(int k) {
    if (k < stack_.low() || k >= stack_.high()) return nullptr;
    return &layers_[static_cast<std::size_t>(k - stack_.low()) % layers_.size()];
  }

  void begin(int k) {
    CutLayer& layer = *at(k);
    layer.samples = stack_.at(k);
    layer.parity = k & 1;
    layer.beyond = stack_.beyond(k);
    layer.capped_sides = cap_sides_ && layer.samples->flat_sides;
    mark_inside(layer);
  }

  const Stack& stack_;
  VertexPlacement placement_;
  Clustering clustering_;
  bool cap_sides_;
  std::vector<CutLayer> layers_;
  int begun_;
  int cut_;
};

void mesh_cubes(const Stack& stack, int first, int last, std::span<LayerMesh> meshes) {
  const auto mesh_layer = [&stack](int k) {
    return cube_layer({{stack.at(k - 1), stack.at(k), stack.at(k + 1), stack.at(k + 2)}},
                      {{stack.beyond(k - 1), stack.beyond(k), stack.beyond(k + 1), stack.beyond(k + 2)}});
  };
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
}

}  // namespace

class StackMesher::Layers {
 public:
  Layers(std::span<const SampledLayer* const> stack, const MesherOptions& options, int first)
      : stack_(stack, options), next_(first) {
    if (options.mesher != Mesher::kCubes) tetrahedra_.emplace(stack_, options, first);
  }

  /// As many as in `meshes`.
  void mesh_next(std::span<LayerMesh> meshes) {
    for (std::size_t done = 0; done < meshes.size();) {
      const std::size_t count = std::min<std::size_t>(kLayersAtATime, meshes.size() - done);
      const int last = next_ + static_cast<int>(count);
      stack_.make_ends(next_ - kLayerReach, last + kLayerReach);
      if (tetrahedra_) {
        tetrahedra_->mesh(next_, last, meshes.subspan(done, count));
      } else {
        mesh_cubes(stack_, next_, last, meshes.subspan(done, count));
      }
      next_ = last;
      done += count;
    }
  }

  std::span<const LayerMesh> mesh_to(int last) {
    assert(last >= next_);
    const auto count = static_cast<std::size_t>(last - next_);
    if (meshes_.size() < count) meshes_.resize(count);
    mesh_next(std::span(meshes_).first(count));
    return std::span(meshes_).first(count);
  }

 private:
  Stack stack_;
  int next_;
  std::optional<TetrahedraLayers> tetrahedra_;
  std::vector<LayerMesh> meshes_;
};

StackMesher::StackMesher(std::span<const SampledLayer* const> stack, const MesherOptions& options)
    : layers_(std::make_unique<Layers>(stack, options, 0)) {
  assert(stack.size() >= 2);
}

StackMesher::~StackMesher() = default;

std::span<const LayerMesh> StackMesher::mesh_to(int last) { return layers_->mesh_to(last); }

std::vector<LayerMesh> mesh_layers(std::span<const SampledLayer* const> stack, int first, int last,
                                   const MesherOptions& options) {
  assert(0 <= first && first <= last && last <= static_cast<int>(stack.size()));
  assert(stack.size() >= 2);
  std::vector<LayerMesh> meshes(static_cast<std::size_t>(last - first));
  StackMesher::Layers(stack, options, first).mesh_next(meshes);
  return meshes;
}

}  // namespace fathom
