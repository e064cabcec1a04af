#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/body_centred.h"
#include "surface/lattice_link.h"
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
  EdgeMask cut = 0;          ///< edges whose ends lie on different sides of the surface
  EdgeMask near = 0;         ///< those of them that are cut nearer to this sample than to the other
  EdgeMask kept = 0;         ///< those near cuts whose cluster becomes one vertex
  bool single : 1 = false;   ///< all near cuts become one vertex
  bool made_up : 1 = false;  ///< not a sample of the field
  Link link : 3 = Link::kInner;
  std::int32_t first_vertex = 0;  ///< of this sample, among the layer's
  /// The change of the field with each step of (m, j, k), by least squares over the edges; zero where made up.
  std::array<float, 3> change{};
};

/// A layer of the body-centred lattice and where the surface cuts it. Treece 2000, sections 3.4.2 and 3.4.3.
struct CutLayer {
  const SampledLayer* samples = nullptr;
  int parity = 0;             ///< of the layer's number
  bool beyond = false;        ///< made up, all outside, to close the surface at an end
  bool capped_sides = false;  ///< beyond its flat sides all is outside

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
  /// Where a sample lies along its row, in half columns.
  int half_columns(int row, int column) const {
    const int m = 2 * column + (shifted(row) ? 1 : 0);
    return samples->flat_sides ? std::clamp(m, 1, 2 * samples->columns - 2) : m;
  }
  Link link(int row, int column) const {
    if (!samples->flat_sides || (column > 0 && column + 1 < samples->columns)) return Link::kInner;
    return column == 0 ? face_link(false, shifted(row)) : face_link(true, !shifted(row));
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

/// How far an edge leads along the rows, in half columns: as the lattice says but for samples on flat sides.
inline int step_along(const CutLayer& layer, int row, int column, int edge) {
  const int m = kLatticeSteps[static_cast<std::size_t>(edge)].m;
  if (!layer.samples->flat_sides) return m;
  const int last = 2 * layer.samples->columns - 2;
  const int from = 2 * column + (layer.shifted(row) ? 1 : 0);
  return std::clamp(from + m, 1, last) - std::clamp(from, 1, last);
}

/// Fills in `inside` and `words`.
void mark_inside(CutLayer& layer);

/// Fills in the rest. `below` and `above` are null where the stack ends; their `inside` is filled in.
void mark_cuts(CutLayer& layer, const CutLayer* below, const CutLayer* above, Clustering clustering);

}  // namespace fathom
