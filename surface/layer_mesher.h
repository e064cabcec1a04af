#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surface/layer_mesh.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// How a field's samples become triangles.
enum class Mesher {
  kRegularised,  ///< marching tetrahedra with clustered vertices, Treece 2000, section 3.4
  kTetrahedra,   ///< marching tetrahedra
  kCubes         ///< marching cubes
};

/// Where a clustered vertex goes.
enum class VertexPlacement {
  kAverage,   ///< the middle of the cuts that it stands for
  kCurvature  ///< their mean, cuts where the surface bends most weighing most; eq. (3.13) to (3.16)
};

struct MesherOptions {
  Mesher mesher = Mesher::kRegularised;
  VertexPlacement placement = VertexPlacement::kAverage;
  /// Closes the surface flat on the first and last layer of the stack: as if one more layer, all outside, lay directly
  /// beyond. Vertices of the rim stay in the end layer's plane.
  bool cap_ends = false;
  /// The same on the sides of layers that have flat ones, just where these are.
  bool cap_sides = false;
  /// The lattice that the mesher needs.
  Lattice lattice() const { return mesher == Mesher::kCubes ? Lattice::kCubic : Lattice::kBodyCentred; }
};

/// How many layers beyond a layer its mesh depends on, on either side.
inline constexpr int kLayerReach = 3;

/// The meshes of layers `first` to `last - 1` of a stack, whose layer 0 has parity 0. All layers have the same numbers
/// of columns and rows. The result for a layer depends on no more than the layers within kLayerReach of it and not on
/// `first` and `last`, so that meshes made piece by piece join exactly.
///
/// The surface is open where the field is inside at the border of the stack (at a first or last layer, unless these are
/// capped, at a first or last row or column) and otherwise closed, 2-manifold and consistently oriented, with the
/// topology of marching tetrahedra (cubes). Triangles face outward where column step, row step and the way to the next
/// layer are a right-handed system; normals face outward always.
/// Runs in parallel; the result does not depend on the number of threads.
std::vector<LayerMesh> mesh_layers(std::span<const SampledLayer* const> stack, int first, int last,
                                   const MesherOptions& options);

/// The same for a stack that is too deep to be kept: from its first layer on, some layers at a time, without working
/// anything out twice and in the same memory.
class StackMesher {
 public:
  /// `stack` has an element for each layer, which only need point to layers as mesh_to says.
  StackMesher(std::span<const SampledLayer* const> stack, const MesherOptions& options);
  ~StackMesher();
  StackMesher(const StackMesher&) = delete;
  StackMesher& operator=(const StackMesher&) = delete;

  /// The meshes of the layers from the end of the last call to `last - 1`; valid until the next call. Layers of the
  /// stack must be there, and stay where they are, from kLayerReach below the first of these to kLayerReach above the
  /// last.
  std::span<const LayerMesh> mesh_to(int last);

 private:
  friend std::vector<LayerMesh> mesh_layers(std::span<const SampledLayer* const> stack, int first, int last,
                                            const MesherOptions& options);
  class Layers;
  std::unique_ptr<Layers> layers_;
};

}  // namespace fathom
