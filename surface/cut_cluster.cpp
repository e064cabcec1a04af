#include "surface/cut_cluster.h"

#include <span>
#include <vector>

namespace fathom {

namespace {

EdgeMask find_first_cluster(EdgeMask near, const LinkTable& link) {
  auto cluster = static_cast<EdgeMask>(near & (~near + 1));
  for (EdgeMask to_do = cluster; to_do != 0;) {
    const auto e = static_cast<std::size_t>(std::countr_zero(to_do));
    to_do = static_cast<EdgeMask>(to_do & (to_do - 1));
    const auto found = static_cast<EdgeMask>(link.next[e] & near & static_cast<EdgeMask>(~cluster));
    cluster |= found;
    to_do |= found;
  }
  return cluster;
}

}  // namespace

EdgeMask first_cluster(EdgeMask near, Link link) {
  if ((near & (near - 1)) == 0) return near;
  if (link != Link::kInner) return find_first_cluster(near, link_table(link));
  static const std::vector<EdgeMask> table = [] {
    std::vector<EdgeMask> all(kAllEdges + 1);
    for (unsigned mask = 1; mask <= kAllEdges; ++mask) {
      all[mask] = find_first_cluster(static_cast<EdgeMask>(mask), link_table(Link::kInner));
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
    const EdgeMask cluster = first_cluster(rest, sample.link);
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

  std::span<const Step> all() const { return std::span(steps).first(static_cast<std::size_t>(length)); }
};

Ring ring_around(EdgeMask cluster, const LinkTable& link) {
  const auto outside = static_cast<EdgeMask>(~cluster & kAllEdges);
  int crossings = 0;
  int x = -1;
  for (EdgeMask rest = cluster; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
    const int e = std::countr_zero(rest);
    const int here = std::popcount(static_cast<EdgeMask>(link.next[static_cast<std::size_t>(e)] & outside));
    if (here > 0) x = e;
    crossings += here;
  }
  Ring ring;
  if (x < 0) return ring;
  int y = std::countr_zero(static_cast<EdgeMask>(link.next[static_cast<std::size_t>(x)] & outside));
  const int first_x = x;
  const int first_y = y;
  int length = 0;
  do {
    ring.steps[static_cast<std::size_t>(length++)] = {static_cast<std::int8_t>(x), static_cast<std::int8_t>(y)};
    const int z = link.left[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
    (has_edge(cluster, z) ? x : y) = z;
  } while (x != first_x || y != first_y);
  if (length == crossings) ring.length = length;
  return ring;
}

// The rings around all clusters of inner samples, one after the other.
class Rings {
 public:
  Rings() {
    begin_.reserve(kAllEdges + 2);
    for (unsigned mask = 0; mask <= kAllEdges; ++mask) {
      begin_.push_back(static_cast<std::int32_t>(steps_.size()));
      const auto cluster = static_cast<EdgeMask>(mask);
      if (cluster == 0 || first_cluster(cluster, Link::kInner) != cluster) continue;
      const Ring ring = ring_around(cluster, link_table(Link::kInner));
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

std::span<const Ring::Step> inner_ring(EdgeMask cluster) {
  static const Rings rings;
  return rings.around(cluster);
}

constexpr unsigned kBorder = kLatticeEdges;

// The end of an edge that the cut of a step is near to.
unsigned label_of(const Ring::Step& step, EdgeMask cut, const Star& star) {
  const auto x = static_cast<unsigned>(step.x);
  const auto y = static_cast<unsigned>(step.y);
  if (!has_edge(star.there, step.y)) return kBorder;
  const bool near_x = !has_edge(cut, step.y) && nearer_to_first(star.value[x], star.value[y], x < y);
  return near_x ? x : y;
}

bool may_become_one(std::span<const Ring::Step> ring, EdgeMask cut, const Star& star) {
  if (ring.empty()) return false;

  // The diagonal of a quadrilateral leads from a cut of the cluster, OX, past a cut beside it, OY, to PY, which then is
  // on the ring as well. That changes nothing: diagonals go by the handedness of the tetrahedron alone, so that of the
  // two beside the triangle OPY just one has such a diagonal, and PY is met once; and as OX is near O and OY near Y, PY
  // is either near Y, like OY, or near P, and then so is PX, which comes before.

  // Of each cut on the ring: the sample that it is near to, as `label`, and the end of the edge from the centre that is
  // cut, as `whole`. Each may be met in one run only.
  constexpr unsigned kNone = kLatticeEdges + 1;
  const auto whole_of = [&](const Ring::Step& step) {
    return has_edge(cut, step.y) ? static_cast<unsigned>(step.y) : kNone;
  };
  unsigned label_before = label_of(ring.back(), cut, star);
  unsigned whole_before = whole_of(ring.back());
  unsigned labels = 0;
  unsigned label_runs = 0;
  unsigned wholes = 0;
  unsigned whole_twice = 0;
  for (const Ring::Step& step : ring) {
    const unsigned label = label_of(step, cut, star);
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

}  // namespace

bool collapsible(EdgeMask cluster, EdgeMask cut, const Star& star, Link link) {
  if (link == Link::kInner) return may_become_one(inner_ring(cluster), cut, star);
  const Ring ring = ring_around(cluster, link_table(link));
  return may_become_one(ring.all(), cut, star);
}

bool has_chord(EdgeMask cluster, EdgeMask cut, const Star& star, Link link, const Wall& wall) {
  if ((cluster & wall.within) == 0) return false;
  const Ring whole = ring_around(cluster, link_table(link));
  const std::span<const Ring::Step> ring = whole.all();
  if (ring.empty()) return false;
  const auto on_wall = [&wall](unsigned label) {
    return label != kBorder && has_edge(wall.within, static_cast<int>(label));
  };
  // Tetrahedra beyond the wall are those of a cap, which lies on it.
  const auto beyond = [&wall, &star](const Ring::Step& step) {
    return ((edge_bit(step.x) | edge_bit(step.y)) & (wall.through | ~star.there)) != 0;
  };
  const Ring::Step* before = &ring.back();
  for (const Ring::Step& step : ring) {
    const unsigned a = label_of(*before, cut, star);
    const unsigned b = label_of(step, cut, star);
    if (!beyond(*before) && !beyond(step)) {
      if (a != b && on_wall(a) && on_wall(b)) return true;
      // A diagonal may lead to the cut opposite, between the ends of both steps.
      if (before->x == step.x && has_edge(cut, before->y) != has_edge(cut, step.y)) {
        const auto y = static_cast<unsigned>(before->y);
        const auto z = static_cast<unsigned>(step.y);
        const unsigned c = nearer_to_first(star.value[y], star.value[z], y < z) ? y : z;
        if (on_wall(c) && ((c != a && on_wall(a)) || (c != b && on_wall(b)))) return true;
      }
    }
    before = &step;
  }
  return false;
}

}  // namespace fathom
