#include "surface/cut_layer.h"

#include <algorithm>
#include <span>
#include <utility>

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

Stars::Stars(const CutLayer& layer, const CutLayer* below, const CutLayer* above)
    : layer_(layer), around_{below, &layer, above}, has_both_(below && above) {
  for (std::size_t i = 0; i < around_.size(); ++i) {
    if (around_[i]) values_[i] = around_[i]->samples->values.data();
  }
}

Star Stars::border_star(int row, int column) const {
  Star star;
  star.centre = layer_.at(row, column);
  star.value[14] = star.centre;
  star.value[15] = star.centre;
  star.there = 0;
  const auto& steps = kColumnStep[layer_.shifted(row) ? 1 : 0];
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    const LatticeStep& step = kLatticeSteps[e];
    const CutLayer* other = around_[static_cast<std::size_t>(step.k + 1)];
    const int j = row + step.j;
    const int i = column + steps[e];
    if (!other || j < 0 || j >= layer_.samples->rows || i < 0 || i >= layer_.samples->columns) {
      star.value[e] = star.centre;
      continue;
    }
    star.value[e] = other->at(j, i);
    star.there |= edge_bit(static_cast<int>(e));
  }
  return star;
}

EdgeMask first_cluster(EdgeMask near) {
  if ((near & (near - 1)) == 0) return near;
  static const std::vector<EdgeMask> table = [] {
    std::vector<EdgeMask> all(kAllEdges + 1);
    for (std::size_t mask = 1; mask < all.size(); ++mask) {
      auto cluster = static_cast<EdgeMask>(mask & (~mask + 1));
      for (EdgeMask to_do = cluster; to_do != 0;) {
        const auto e = static_cast<std::size_t>(std::countr_zero(to_do));
        to_do = static_cast<EdgeMask>(to_do & (to_do - 1));
        const auto found = static_cast<EdgeMask>(kNextEdges[e] & mask & static_cast<EdgeMask>(~cluster));
        cluster |= found;
        to_do |= found;
      }
      all[mask] = cluster;
    }
    return all;
  }();
  return table[near];
}

std::int32_t vertex_of(const CutSample& sample, int edge) {
  std::int32_t vertex = sample.first_vertex;
  if (sample.single) return vertex;
  EdgeMask rest = sample.near;
  while (true) {
    const EdgeMask cluster = first_cluster(rest);
    const bool kept = (cluster & sample.kept) != 0;
    if (has_edge(cluster, edge)) {
      const auto before = static_cast<EdgeMask>(cluster & (edge_bit(edge) - 1));
      return kept ? vertex : vertex + count_ones(before);
    }
    vertex += kept ? 1 : count_ones(cluster);
    rest = static_cast<EdgeMask>(rest & ~cluster);
  }
}

namespace {

// Edges of the link from a vertex of a cluster, `x`, to one that is not in it, `y`, in the order around the cluster.
struct Ring {
  struct Step {
    std::int8_t x = 0;
    std::int8_t y = 0;
  };
  static constexpr std::size_t kMostSteps = 36;

  int length = 0;  // 0 where they are not one circle, since the patch is not a disc
  std::array<Step, kMostSteps> steps;
};

Ring ring_around(EdgeMask cluster) {
  const auto outside = static_cast<EdgeMask>(~cluster & kAllEdges);
  int crossings = 0;
  int x = -1;
  for (EdgeMask rest = cluster; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
    const int e = std::countr_zero(rest);
    const int here = std::popcount(static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(e)] & outside));
    if (here > 0) x = e;
    crossings += here;
  }
  Ring ring;
  if (x < 0) return ring;
  int y = std::countr_zero(static_cast<EdgeMask>(kNextEdges[static_cast<std::size_t>(x)] & outside));
  const int first_x = x;
  const int first_y = y;
  int length = 0;
  do {
    ring.steps[static_cast<std::size_t>(length++)] = {static_cast<std::int8_t>(x), static_cast<std::int8_t>(y)};
    const int z = kLeftOf[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
    (has_edge(cluster, z) ? x : y) = z;
  } while (x != first_x || y != first_y);
  if (length == crossings) ring.length = length;
  return ring;
}

// The rings around all clusters, one after the other.
class Rings {
 public:
  Rings() {
    begin_.reserve(kAllEdges + 2);
    for (unsigned mask = 0; mask <= kAllEdges; ++mask) {
      begin_.push_back(static_cast<std::int32_t>(steps_.size()));
      const auto cluster = static_cast<EdgeMask>(mask);
      if (cluster == 0 || first_cluster(cluster) != cluster) continue;
      const Ring ring = ring_around(cluster);
      steps_.insert(steps_.end(), ring.steps.begin(), ring.steps.begin() + ring.length);
    }
    begin_.push_back(static_cast<std::int32_t>(steps_.size()));
  }

  std::span<const Ring::Step> around(EdgeMask cluster) const {
    const auto begin = static_cast<std::size_t>(begin_[cluster]);
    return std::span(steps_).subspan(begin, static_cast<std::size_t>(begin_[cluster + std::size_t{1}]) - begin);
  }

 private:
  std::vector<std::int32_t> begin_;
  std::vector<Ring::Step> steps_;
};

}  // namespace

bool collapsible(EdgeMask cluster, EdgeMask cut, const Star& star) {
  static const Rings rings;
  const std::span<const Ring::Step> ring = rings.around(cluster);
  if (ring.empty()) return false;

  // The diagonal of a quadrilateral leads from a cut of the cluster, OX, past a cut beside it, OY, to PY, which then is
  // on the ring as well. That changes nothing: diagonals go by the handedness of the tetrahedron alone, so that of the
  // two beside the triangle OPY just one has such a diagonal, and PY is met once; and as OX is near O and OY near Y, PY
  // is either near Y, like OY, or near P, and then so is PX, which comes before.

  // Of each cut on the ring: the sample that it is near to, as `label`, and the end of the edge from the centre that is
  // cut, as `whole`. Each may be met in one run only.
  constexpr unsigned kBorder = kLatticeEdges;
  constexpr unsigned kNone = kLatticeEdges + 1;
  const auto label_of = [&](const Ring::Step& step) {
    const auto x = static_cast<unsigned>(step.x);
    const auto y = static_cast<unsigned>(step.y);
    if (!has_edge(star.there, step.y)) return kBorder;
    const bool near_x = !has_edge(cut, step.y) && nearer_to_first(star.value[x], star.value[y], x < y);
    return near_x ? x : y;
  };
  const auto whole_of = [&](const Ring::Step& step) {
    return has_edge(cut, step.y) ? static_cast<unsigned>(step.y) : kNone;
  };
  unsigned label_before = label_of(ring.back());
  unsigned whole_before = whole_of(ring.back());
  unsigned labels = 0;
  unsigned label_runs = 0;
  unsigned wholes = 0;
  unsigned whole_twice = 0;
  for (const Ring::Step& step : ring) {
    const unsigned label = label_of(step);
    labels |= 1U << label;
    label_runs += label != label_before ? 1U : 0U;
    label_before = label;
    const unsigned whole = whole_of(step);
    const unsigned begins = whole != whole_before ? 1U << whole : 0U;
    whole_twice |= wholes & begins;
    wholes |= begins;
    whole_before = whole;
  }
  whole_twice &= ~(1U << kNone);
  return whole_twice == 0 && label_runs >= 3 && label_runs == static_cast<unsigned>(count_ones(labels));
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

// The same where some ends are not of the field: such an end is where the straight line through the sample and the
// opposite end leads.
std::array<float, 3> change_at_border(const Star& star, EdgeMask of_field) {
  std::array<float, kLatticeEdges> value;
  std::copy_n(star.value.begin(), kLatticeEdges, value.begin());
  for (int e = 0; e < kLatticeEdges; ++e) {
    if (has_edge(of_field, e)) continue;
    const float opposite = star.value[static_cast<std::size_t>(opposite_edge(e))];
    value[static_cast<std::size_t>(e)] =
        has_edge(of_field, opposite_edge(e)) ? 2.0F * star.centre - opposite : star.centre;
  }
  return change_in(value.data());
}

// The edges whose ends are samples of the field.
EdgeMask ends_of_field(const Star& star) {
  EdgeMask result = star.there;
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    if (star.value[e] == kFarOutside) result = static_cast<EdgeMask>(result & ~edge_bit(static_cast<int>(e)));
  }
  return result;
}

// Decides which near cuts become one vertex and counts the layer's vertices.
void cluster_cuts(const Star& star, Clustering clustering, CutLayer& layer, CutSample& sample) {
  sample.first_vertex = layer.vertices;
  for (EdgeMask rest = sample.near; rest != 0;) {
    const EdgeMask cluster = first_cluster(rest);
    rest = static_cast<EdgeMask>(rest & ~cluster);
    const bool one = (cluster & (cluster - 1)) == 0;
    if (one || (clustering == Clustering::kClusters && collapsible(cluster, sample.cut, star))) {
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
      if (bits.quiet(w, words)) continue;
      const std::uint64_t own = bits.at[1][1][w];
      std::uint64_t any = 0;
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
        const Star star = stars.at(j, sample.column);
        mark_edges(star, sample);
        if (at_end || side_row || sample.column <= 1 || sample.column + 2 >= columns) {
          sample.made_up = star.centre == kFarOutside;
          if (!sample.made_up) sample.change = change_at_border(star, ends_of_field(star));
        } else {
          sample.change = change_in(star.value.data());
        }
        cluster_cuts(star, clustering, layer, sample);
      }
    }
  }
  layer.row_begin.back() = static_cast<std::int32_t>(layer.cuts.size());
}

}  // namespace fathom
