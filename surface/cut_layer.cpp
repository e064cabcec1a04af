#include "surface/cut_layer.h"

#include <algorithm>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace fathom {

namespace {

// kColumnStep[shifted][e]: from the column of a sample to that of the end of edge e, which depends on whether the
// sample's row is shifted by half a column.
constexpr std::array<std::array<int, kLatticeEdges>, 2> kColumnStep = [] {
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

std::uint64_t inside_word(const float* values, int count) {
  std::uint64_t word = 0;
  int i = 0;
#if defined(__SSE2__)
  const __m128 zero = _mm_setzero_ps();
  for (; i + 4 <= count; i += 4) {
    const auto four = static_cast<unsigned>(_mm_movemask_ps(_mm_cmpge_ps(_mm_loadu_ps(values + i), zero)));
    word |= std::uint64_t{four} << i;
  }
#endif
  for (; i < count; ++i) word |= std::uint64_t{values[i] >= 0.0F} << i;
  return word;
}

// The bits of a row moved so that bit i is that of column i + step; `step` is -1, 0 or 1. Columns that do not exist are
// 0.
std::uint64_t moved(const std::uint64_t* row, int word, int words, int step) {
  if (step == 0) return row[word];
  if (step > 0) return row[word] >> 1 | (word + 1 < words ? row[word + 1] << 63 : 0);
  return row[word] << 1 | (word > 0 ? row[word - 1] >> 63 : 0);
}

const CutLayer* layer_at(const CutLayer& layer, const CutLayer* below, const CutLayer* above, int step) {
  return step == 0 ? &layer : step < 0 ? below : above;
}

}  // namespace

EdgeEnd edge_end(const CutLayer& layer, int row, int column, int edge) {
  const auto e = static_cast<std::size_t>(edge);
  const LatticeStep& step = kLatticeSteps[e];
  return {row + step.j, column + kColumnStep[layer.shifted(row) ? 1 : 0][e], step.k};
}

void mark_inside(CutLayer& layer) {
  const int columns = layer.samples->columns;
  const int rows = layer.samples->rows;
  layer.words = (columns + 63) / 64;
  layer.inside.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(layer.words));
  const float* values = layer.samples->values.data();
  std::uint64_t* word = layer.inside.data();
  for (int j = 0; j < rows; ++j, values += columns) {
    for (int i = 0; i < columns; i += 64) *word++ = inside_word(values + i, std::min(64, columns - i));
  }
}

Star star_of(const CutLayer& layer, const CutLayer* below, const CutLayer* above, int row, int column) {
  Star star;
  star.centre = layer.at(row, column);
  const int columns = layer.samples->columns;
  const int rows = layer.samples->rows;
  const auto& steps = kColumnStep[layer.shifted(row) ? 1 : 0];
  if (row > 0 && row + 1 < rows && column > 0 && column + 1 < columns && below && above) {
    const std::ptrdiff_t place = std::ptrdiff_t{row} * columns + column;
    const std::array<const float*, 3> centres{below->samples->values.data() + place,
                                              layer.samples->values.data() + place,
                                              above->samples->values.data() + place};
    for (std::size_t e = 0; e < kLatticeEdges; ++e) {
      const LatticeStep& step = kLatticeSteps[e];
      star.value[e] = centres[static_cast<std::size_t>(step.k + 1)][step.j * columns + steps[e]];
    }
    star.there = kAllEdges;
    return star;
  }
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    const LatticeStep& step = kLatticeSteps[e];
    const CutLayer* other = layer_at(layer, below, above, step.k);
    const int j = row + step.j;
    const int i = column + steps[e];
    if (!other || j < 0 || j >= rows || i < 0 || i >= columns) {
      star.value[e] = star.centre;  // never cut
      continue;
    }
    star.value[e] = other->at(j, i);
    star.there |= edge_bit(static_cast<int>(e));
  }
  return star;
}

EdgeMask cluster_of(EdgeMask near, int edge) {
  EdgeMask cluster = edge_bit(edge);
  EdgeMask to_do = cluster;
  while (to_do != 0) {
    const int e = std::countr_zero(to_do);
    to_do = static_cast<EdgeMask>(to_do & (to_do - 1));
    const auto found =
        static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(e)] & near & static_cast<EdgeMask>(~cluster));
    cluster |= found;
    to_do |= found;
  }
  return cluster;
}

std::int32_t vertex_of(const CutSample& sample, int edge) {
  std::int32_t vertex = sample.first_vertex;
  EdgeMask rest = sample.near;
  while (true) {
    const EdgeMask cluster = cluster_of(rest, std::countr_zero(rest));
    const bool kept = (cluster & sample.kept) != 0;
    if (has_edge(cluster, edge)) {
      const auto before = static_cast<EdgeMask>(cluster & (edge_bit(edge) - 1));
      return kept ? vertex : vertex + std::popcount(before);
    }
    vertex += kept ? 1 : std::popcount(cluster);
    rest = static_cast<EdgeMask>(rest & ~cluster);
  }
}

bool collapsible(EdgeMask cluster, EdgeMask cut, const Star& star) {
  const auto outside = static_cast<EdgeMask>(~cluster & kAllEdges);
  int crossings = 0;
  int x = -1;
  for (EdgeMask rest = cluster; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
    const int e = std::countr_zero(rest);
    const int here = std::popcount(static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(e)] & outside));
    if (here > 0) x = e;
    crossings += here;
  }
  if (x < 0) return false;
  int y = std::countr_zero(static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(x)] & outside));

  // A cut beside the cluster that nearly all around it belongs to the cluster: its cut on the far side would be met
  // from both sides through the diagonals of quadrilaterals.
  for (auto rest = static_cast<EdgeMask>(cut & outside); rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
    const int e = std::countr_zero(rest);
    const auto far = static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(e)] & outside);
    if (std::popcount(far) == 1 && (far & cut) == 0) return false;
  }

  // The ring: edges of the link from a vertex of the cluster to one that is not. It is one circle if, and only if, the
  // patch is a disc.
  constexpr int kBorder = kLatticeEdges;
  constexpr std::size_t kMostCrossings = 36;
  std::array<std::int8_t, kMostCrossings> label;  // the sample that the ring's cut is near to
  std::array<std::int8_t, kMostCrossings> whole;  // the end of the edge from the centre that is cut; else -1
  int length = 0;
  const int first_x = x;
  const int first_y = y;
  do {
    const auto xi = static_cast<std::size_t>(x);
    const auto yi = static_cast<std::size_t>(y);
    const bool cut_from_centre = has_edge(cut, y);
    int near = y;
    if (!has_edge(star.there, y)) {
      near = kBorder;
    } else if (!cut_from_centre && nearer_to_first(star.value[xi], star.value[yi], x < y)) {
      near = x;
    }
    label[static_cast<std::size_t>(length)] = static_cast<std::int8_t>(near);
    whole[static_cast<std::size_t>(length)] = static_cast<std::int8_t>(cut_from_centre ? y : -1);
    ++length;
    const int z = kLeftOf[xi][yi];
    (has_edge(cluster, z) ? x : y) = z;
  } while (x != first_x || y != first_y);
  if (length != crossings) return false;

  unsigned labels = 0;
  unsigned wholes = 0;
  int label_runs = 0;
  for (int i = 0; i < length; ++i) {
    const auto here = static_cast<std::size_t>(i);
    const auto before = static_cast<std::size_t>(i > 0 ? i - 1 : length - 1);
    labels |= 1U << label[here];
    label_runs += label[here] != label[before] ? 1 : 0;
    if (whole[here] >= 0 && whole[here] != whole[before]) {
      if ((wholes >> whole[here] & 1U) != 0) return false;
      wholes |= 1U << whole[here];
    }
  }
  return label_runs >= 3 && label_runs == std::popcount(labels);
}

void mark_cuts(CutLayer& layer, const CutLayer* below, const CutLayer* above, Clustering clustering) {
  const int columns = layer.samples->columns;
  const int rows = layer.samples->rows;
  const int words = layer.words;
  layer.active.assign(layer.inside.size(), 0);
  layer.before.assign(layer.inside.size(), 0);
  layer.cuts.clear();
  layer.vertices = 0;
  const std::vector<std::uint64_t> whole_row = [&] {
    std::vector<std::uint64_t> row(static_cast<std::size_t>(words), ~std::uint64_t{0});
    if (columns % 64 != 0) row.back() = (std::uint64_t{1} << (columns % 64)) - 1;
    return row;
  }();

  for (int j = 0; j < rows; ++j) {
    const auto& steps = kColumnStep[layer.shifted(j) ? 1 : 0];
    std::array<const std::uint64_t*, kLatticeEdges> other_row;
    for (std::size_t e = 0; e < kLatticeEdges; ++e) {
      const LatticeStep& step = kLatticeSteps[e];
      const CutLayer* other = layer_at(layer, below, above, step.k);
      const int row = j + step.j;
      other_row[e] = other && row >= 0 && row < rows
                         ? other->inside.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(words)
                         : nullptr;
    }
    const std::uint64_t* own_row = layer.inside.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(words);
    for (int w = 0; w < words; ++w) {
      const auto place = static_cast<std::size_t>(j * words + w);
      layer.before[place] = static_cast<std::int32_t>(layer.cuts.size());
      const std::uint64_t real = whole_row[static_cast<std::size_t>(w)];
      std::array<std::uint64_t, kLatticeEdges> differs;
      std::uint64_t any = 0;
      for (std::size_t e = 0; e < kLatticeEdges; ++e) {
        differs[e] = 0;
        if (!other_row[e]) continue;
        differs[e] =
            (own_row[w] ^ moved(other_row[e], w, words, steps[e])) & real & moved(whole_row.data(), w, words, steps[e]);
        any |= differs[e];
      }
      layer.active[place] = any;
      for (; any != 0; any &= any - 1) {
        const int bit = std::countr_zero(any);
        CutSample sample;
        sample.row = j;
        sample.column = 64 * w + bit;
        for (int e = 0; e < kLatticeEdges; ++e) {
          sample.cut |= static_cast<EdgeMask>((differs[static_cast<std::size_t>(e)] >> bit & 1) << e);
        }
        const Star star = star_of(layer, below, above, j, sample.column);
        for (EdgeMask rest = sample.cut; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
          const int e = std::countr_zero(rest);
          if (nearer_to_first(star.centre, star.value[static_cast<std::size_t>(e)], e >= kFirstForwardEdge)) {
            sample.near |= edge_bit(e);
          }
        }
        sample.first_vertex = layer.vertices;
        for (EdgeMask rest = sample.near; rest != 0;) {
          const EdgeMask cluster = cluster_of(rest, std::countr_zero(rest));
          rest = static_cast<EdgeMask>(rest & ~cluster);
          const bool single = std::has_single_bit(cluster);
          if (single || (clustering == Clustering::kClusters && collapsible(cluster, sample.cut, star))) {
            sample.kept |= cluster;
            ++layer.vertices;
          } else {
            layer.vertices += std::popcount(cluster);
          }
        }
        layer.cuts.push_back(sample);
      }
    }
  }
}

}  // namespace fathom
