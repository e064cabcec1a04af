#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "surface/body_centred.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// std::popcount is a call where the processor need not have the instruction.
inline std::int32_t count_ones(std::uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555U;
  bits = (bits & 0x3333333333333333U) + (bits >> 2 & 0x3333333333333333U);
  bits = (bits + (bits >> 4)) & 0x0F0F0F0F0F0F0F0FU;
  return static_cast<std::int32_t>(bits * 0x0101010101010101U >> 56);
}

/// Lower than any field: the value of samples that are made up to close the surface. It is cut directly at its
/// neighbours.
inline constexpr float kFarOutside = -1e30F;

/// A sample from which at least one edge is cut by the surface.
struct CutSample {
  std::int32_t row = 0;
  std::int32_t column = 0;
  EdgeMask cut = 0;               ///< edges whose ends lie on different sides of the surface
  EdgeMask near = 0;              ///< those of them that are cut nearer to this sample than to the other
  EdgeMask kept = 0;              ///< those near cuts whose cluster becomes one vertex
  bool single = false;            ///< all near cuts become one vertex
  bool made_up = false;           ///< not a sample of the field
  std::int32_t first_vertex = 0;  ///< of this sample, among the layer's
  /// The change of the field with each step of (m, j, k), by least squares over the edges; zero where made up.
  std::array<float, 3> change{};
};

/// The values at a sample and at the ends of its edges. The value is that of the centre where the end is missing, and
/// behind the last edge, so that it is not cut.
struct Star {
  alignas(16) std::array<float, 16> value;
  float centre;
  EdgeMask there;  ///< edges whose ends are in the stack
};

/// A layer of the body-centred lattice and where the surface cuts it. Treece 2000, sections 3.4.2 and 3.4.3.
struct CutLayer {
  const SampledLayer* samples = nullptr;
  int parity = 0;       ///< of the layer's number
  bool beyond = false;  ///< made up, all outside, to close the surface at an end

  int words = 0;                        ///< of 64 samples, in each row
  std::vector<std::uint64_t> inside;    ///< a bit for each sample
  std::vector<std::uint64_t> active;    ///< a bit for each element of `cuts`
  std::vector<std::int32_t> before;     ///< elements of `cuts` before each word of `active`
  std::vector<std::int32_t> row_begin;  ///< the first element of `cuts` of each row, and one more
  std::vector<CutSample> cuts;          ///< by rows and columns, ascending
  std::int32_t vertices = 0;

  bool shifted(int row) const { return ((row + parity) & 1) != 0; }
  float at(int row, int column) const {
    return samples->values[static_cast<std::size_t>(row) * static_cast<std::size_t>(samples->columns) +
                           static_cast<std::size_t>(column)];
  }
  /// The element of `cuts` for a sample that has one.
  const CutSample& cut(int row, int column) const {
    const auto word = static_cast<std::size_t>(row * words + column / 64);
    const std::uint64_t below = active[word] & ((std::uint64_t{1} << (column % 64)) - 1);
    return cuts[static_cast<std::size_t>(before[word] + count_ones(below))];
  }
};

/// How the surface's cuts near a sample become vertices.
enum class Clustering { kClusters, kNone };

/// The end of an edge: `row` and `column` in the layer `layer_step` above.
struct EdgeEnd {
  int row = 0;
  int column = 0;
  int layer_step = 0;
};

/// kColumnStep[shifted][e]: from the column of a sample to that of the end of edge e, which depends on whether the
/// sample's row is shifted by half a column.
inline constexpr std::array<std::array<int, kLatticeEdges>, 2> kColumnStep = [] {
  std::array<std::array<int, kLatticeEdges>, 2> table{};
  for (int shifted = 0; shifted < 2; ++shifted) {
    for (std::size_t e = 0; e < kLatticeEdges; ++e) {
      const LatticeStep& step = kLatticeSteps[e];
      const int other = (step.j + step.k) % 2 == 0 ? shifted : 1 - shifted;
      table[static_cast<std::size_t>(shifted)][e] = (step.m + shifted - other) / 2;
    }
  }
  return table;
}();

inline EdgeEnd edge_end(const CutLayer& layer, int row, int column, int edge) {
  const auto e = static_cast<std::size_t>(edge);
  const LatticeStep& step = kLatticeSteps[e];
  return {row + step.j, column + kColumnStep[layer.shifted(row) ? 1 : 0][e], step.k};
}

/// Fills in `inside` and `words`.
void mark_inside(CutLayer& layer);

/// Fills in the rest. `below` and `above` are null where the stack ends; their `inside` is filled in.
void mark_cuts(CutLayer& layer, const CutLayer* below, const CutLayer* above, Clustering clustering);

/// Values around the samples of a layer. `below` and `above` as before.
class Stars {
 public:
  Stars(const CutLayer& layer, const CutLayer* below, const CutLayer* above);

  Star at(int row, int column) const {
    const bool inner =
        has_both_ && row > 0 && row + 1 < layer_.samples->rows && column > 0 && column + 1 < layer_.samples->columns;
    return inner ? inner_star(row, column) : border_star(row, column);
  }

 private:
  Star inner_star(int row, int column) const;
  Star border_star(int row, int column) const;

  const CutLayer& layer_;
  std::array<const CutLayer*, 3> around_;
  std::array<const float*, 3> values_{};
  bool has_both_;
};

inline Star Stars::inner_star(int row, int column) const {
  // In the order of kLatticeSteps. Shifted rows have the ends with m = -1 in the same column, the others one before.
  const std::ptrdiff_t line = layer_.samples->columns;
  const std::ptrdiff_t place = row * line + column;
  const std::ptrdiff_t left = layer_.shifted(row) ? 0 : -1;
  const float* below = values_[0] + place;
  const float* here = values_[1] + place;
  const float* above = values_[2] + place;
  const float* before = here - line + left;
  const float* after = here + line + left;
  Star star;
  star.centre = *here;
  star.there = kAllEdges;
#if defined(__SSE2__)
  float* value = star.value.data();
  _mm_store_ps(value, _mm_setr_ps(below[-line], below[left], below[left + 1], below[line]));
  _mm_store_ps(value + 4, _mm_setr_ps(before[0], before[1], here[-1], here[1]));
  _mm_store_ps(value + 8, _mm_setr_ps(after[0], after[1], above[-line], above[left]));
  _mm_store_ps(value + 12, _mm_setr_ps(above[left + 1], above[line], *here, *here));
#else
  star.value = {below[-line],    below[left], below[left + 1], below[line], before[0],    before[1],
                here[-1],        here[1],     after[0],        after[1],    above[-line], above[left],
                above[left + 1], above[line], *here,           *here};
#endif
  return star;
}

/// Whether the cut of the edge between samples with these values lies nearer to the first; a tie goes to the one that
/// comes first in the order of the lattice.
inline bool nearer_to_first(float first, float second, bool first_comes_first) {
  const float a = first < 0.0F ? -first : first;
  const float b = second < 0.0F ? -second : second;
  return a < b || (a == b && first_comes_first);
}

/// The near cuts that are connected with the first one; `near` is not empty.
EdgeMask first_cluster(EdgeMask near);

/// The vertex, among those of its layer, of the cut of `edge` that is near to the sample.
std::int32_t vertex_of(const CutSample& sample, int edge);

/// Whether the near cuts `cluster` around a sample may become one vertex without a change of topology.
///
/// On the surface of marching tetrahedra a cluster stands for the patch of cells around its cuts. One vertex can take
/// its place when (a) the patch is a disc, and around it, on the ring of cuts that are its neighbours, (b) no cut is
/// met twice and (c) no other cluster is met twice, and at least three are. Because (b) holds for neighbours that stay
/// single cuts and (c) for those that become vertices, it does not matter which of them do: the test depends on the
/// sample's star only, and a mesh of which every cluster passes is a manifold like that of marching tetrahedra.
/// It covers cases (a) to (c) of Treece 2000, figure 3.25, and what these leave open in noisy fields.
bool collapsible(EdgeMask cluster, EdgeMask cut, const Star& star);

}  // namespace fathom
