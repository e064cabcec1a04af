#include "surface/cut_layer.h"

#include <algorithm>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <Eigen/Dense>

#include "surface/cut_cluster.h"
#include "surface/star.h"
#include "surface/wall.h"

namespace fathom {

namespace {

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

namespace {

// Fills in `cut` and `near`: which ends lie on the other side, and which of those farther from the surface.
void mark_edges(const Star& star, CutSample& sample) {
  unsigned other_side = 0;
  unsigned farther = 0;
  unsigned equal = 0;
#if defined(__SSE2__)
  const __m128 zero = _mm_setzero_ps();
  const __m128 magnitude = _mm_castsi128_ps(_mm_set1_epi32(0x7FFFFFFF));
  const __m128 centre = _mm_and_ps(_mm_set1_ps(star.centre), magnitude);
  for (unsigned i = 0; i < 16; i += 4) {
    const __m128 four = _mm_load_ps(star.value.data() + i);
    const __m128 size = _mm_and_ps(four, magnitude);
    other_side |= static_cast<unsigned>(_mm_movemask_ps(_mm_cmpge_ps(four, zero))) << i;
    farther |= static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(centre, size))) << i;
    equal |= static_cast<unsigned>(_mm_movemask_ps(_mm_cmpeq_ps(centre, size))) << i;
  }
#else
  const float centre = star.centre < 0.0F ? -star.centre : star.centre;
  for (unsigned i = 0; i < 16; ++i) {
    const float size = star.value[i] < 0.0F ? -star.value[i] : star.value[i];
    other_side |= (star.value[i] >= 0.0F ? 1U : 0U) << i;
    farther |= (centre < size ? 1U : 0U) << i;
    equal |= (centre == size ? 1U : 0U) << i;
  }
#endif
  constexpr unsigned kForward = kAllEdges & ~((1U << kFirstForwardEdge) - 1);
  if (star.centre >= 0.0F) other_side = ~other_side;
  sample.cut = static_cast<EdgeMask>(other_side & kAllEdges);
  sample.near = static_cast<EdgeMask>(sample.cut & (farther | (equal & kForward)));
}

// The change of the field by least squares over the edges, whose normal matrix is diagonal in this lattice, from the
// values at their ends.
std::array<float, 3> change_in(const float* value) {
  // How the ends of a forward edge differ from those of its opposite.
  const auto along = [value]<int m, int j, int k>(std::integer_sequence<int, m, j, k>) {
    constexpr auto kEdge = static_cast<std::size_t>(edge_along({m, j, k}));
    return value[kEdge] - value[kLatticeEdges - 1 - kEdge];
  };
  const float right = along(std::integer_sequence<int, 2, 0, 0>());
  const float back_left = along(std::integer_sequence<int, -1, 1, 0>());
  const float back_right = along(std::integer_sequence<int, 1, 1, 0>());
  const float up_front = along(std::integer_sequence<int, 0, -1, 1>());
  const float up_left = along(std::integer_sequence<int, -1, 0, 1>());
  const float up_right = along(std::integer_sequence<int, 1, 0, 1>());
  const float up_back = along(std::integer_sequence<int, 0, 1, 1>());
  return {(2.0F * right - back_left + back_right - up_left + up_right) / 16.0F,
          (back_left + back_right - up_front + up_back) / 8.0F, (up_front + up_left + up_right + up_back) / 8.0F};
}

// The edges whose ends are samples of the field.
EdgeMask ends_of_field(const Star& star) {
  EdgeMask result = star.there;
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    if (star.value[e] == kFarOutside) result = static_cast<EdgeMask>(result & ~edge_bit(static_cast<int>(e)));
  }
  return result;
}

// The same where some ends are not of the field, or nearer than elsewhere.
std::array<float, 3> change_at_border(const CutLayer& layer, const CutSample& sample, const Star& star) {
  const EdgeMask of_field = ends_of_field(star);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int e = 0; e < kLatticeEdges; ++e) {
    if (!has_edge(of_field, e)) continue;
    const Eigen::Vector3d step(step_along(layer, sample.row, sample.column, e),
                               kLatticeSteps[static_cast<std::size_t>(e)].j,
                               kLatticeSteps[static_cast<std::size_t>(e)].k);
    normal += step * step.transpose();
    right += (double{star.value[static_cast<std::size_t>(e)]} - double{star.centre}) * step;
  }
  const Eigen::Vector3f change = normal.ldlt().solve(right).cast<float>();
  return {change.x(), change.y(), change.z()};
}

// Decides which near cuts become one vertex and counts the layer's vertices.
void cluster_cuts(const Star& star, Clustering clustering, const Walls* walls, CutLayer& layer, CutSample& sample) {
  sample.first_vertex = layer.vertices;
  for (EdgeMask rest = sample.near; rest != 0;) {
    const EdgeMask cluster = first_cluster(rest, sample.link);
    rest = static_cast<EdgeMask>(rest & ~cluster);
    const bool one = (cluster & (cluster - 1)) == 0;
    const auto may_be_one = [&] {
      if (!collapsible(cluster, sample.cut, star, sample.link)) return false;
      return !walls || std::none_of(walls->begin(), walls->end(), [&](const Wall& wall) {
        return has_chord(cluster, sample.cut, star, sample.link, wall);
      });
    };
    if (one || (clustering == Clustering::kClusters && may_be_one())) {
      sample.kept |= cluster;
      sample.single = cluster == sample.near;
      ++layer.vertices;
    } else {
      layer.vertices += count_ones(cluster);
    }
  }
}

// The rows around a row of a layer, as bits; null where there are none.
struct RowBits {
  std::array<std::array<const std::uint64_t*, 3>, 3> at{};  // by steps of layers and rows, plus 1

  const std::uint64_t* along(const LatticeStep& step) const {
    return at[static_cast<std::size_t>(step.k + 1)][static_cast<std::size_t>(step.j + 1)];
  }

  // Whether all samples around those of a word are on one side.
  bool quiet(int word, int words) const {
    const std::uint64_t own = at[1][1][word];
    if (own != 0 && own != ~std::uint64_t{0}) return false;
    std::uint64_t differs = 0;
    for (const auto& layer : at) {
      for (const std::uint64_t* row : layer) {
        if (!row) continue;
        differs |= row[word] ^ own;
        if (word > 0) differs |= (row[word - 1] ^ own) >> 63;
        if (word + 1 < words) differs |= (row[word + 1] ^ own) & 1U;
      }
    }
    return differs == 0;
  }
};

}  // namespace

void mark_cuts(CutLayer& layer, const CutLayer* below, const CutLayer* above, Clustering clustering) {
  const int columns = layer.samples->columns;
  const int rows = layer.samples->rows;
  const int words = layer.words;
  layer.active.assign(layer.inside.size(), 0);
  layer.before.assign(layer.inside.size(), 0);
  layer.row_begin.assign(static_cast<std::size_t>(rows) + 1, 0);
  layer.cuts.clear();
  layer.vertices = 0;
  std::vector<std::uint64_t> whole_row(static_cast<std::size_t>(words), ~std::uint64_t{0});
  if (columns % 64 != 0) whole_row.back() = (std::uint64_t{1} << (columns % 64)) - 1;
  const std::uint64_t last_column = std::uint64_t{1} << ((columns - 1) % 64);
  const Stars stars(layer, below, above);
  const bool at_end = !below || !above || below->beyond || above->beyond || layer.beyond;

  for (int j = 0; j < rows; ++j) {
    layer.row_begin[static_cast<std::size_t>(j)] = static_cast<std::int32_t>(layer.cuts.size());
    const auto& steps = kColumnStep[layer.shifted(j) ? 1 : 0];
    RowBits bits;
    for (int k = -1; k <= 1; ++k) {
      const CutLayer* other = layer_at(layer, below, above, k);
      for (int row = std::max(0, j - 1); other && row <= std::min(rows - 1, j + 1); ++row) {
        bits.at[static_cast<std::size_t>(k + 1)][static_cast<std::size_t>(row - j + 1)] =
            other->inside.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(words);
      }
    }
    const bool side_row = j <= 1 || j + 2 >= rows;
    for (int w = 0; w < words; ++w) {
      const auto place = static_cast<std::size_t>(j * words + w);
      layer.before[place] = static_cast<std::int32_t>(layer.cuts.size());
      const std::uint64_t own = bits.at[1][1][w];
      // Samples on a capped side, which are cut where they are inside.
      std::uint64_t capped = 0;
      if (layer.capped_sides && w == 0) capped |= own & 1U;
      if (layer.capped_sides && w + 1 == words) capped |= own & last_column;
      if (capped == 0 && bits.quiet(w, words)) continue;
      std::uint64_t any = capped;
      for (std::size_t e = 0; e < kLatticeEdges; ++e) {
        const std::uint64_t* row = bits.along(kLatticeSteps[e]);
        if (row) any |= (own ^ moved(row, w, words, steps[e])) & moved(whole_row.data(), w, words, steps[e]);
      }
      any &= whole_row[static_cast<std::size_t>(w)];
      layer.active[place] = any;
      for (; any != 0; any &= any - 1) {
        CutSample& sample = layer.cuts.emplace_back();
        sample.row = j;
        sample.column = 64 * w + std::countr_zero(any);
        sample.link = layer.link(j, sample.column);
        const Star star = stars.at(j, sample.column);
        mark_edges(star, sample);
        if (at_end || side_row || sample.column <= 1 || sample.column + 2 >= columns) {
          sample.made_up = star.centre == kFarOutside;
          if (!sample.made_up) sample.change = change_at_border(layer, sample, star);
          const Walls walls(layer, below, above, sample, star);
          cluster_cuts(star, clustering, &walls, layer, sample);
        } else {
          sample.change = change_in(star.value.data());
          cluster_cuts(star, clustering, nullptr, layer, sample);
        }
      }
    }
  }
  layer.row_begin.back() = static_cast<std::int32_t>(layer.cuts.size());
}

}  // namespace fathom
