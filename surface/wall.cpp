#include "surface/wall.h"

namespace fathom {

namespace {

enum class Across { kRows, kLayers };

constexpr EdgeMask edges_with(Across across, int step) {
  EdgeMask mask = 0;
  for (int e = 0; e < kLatticeEdges; ++e) {
    const LatticeStep& way = kLatticeSteps[static_cast<std::size_t>(e)];
    if ((across == Across::kRows ? way.j : way.k) == step) mask |= edge_bit(e);
  }
  return mask;
}

constexpr Wall row_wall(int j) { return {{0, j, 0}, edges_with(Across::kRows, 0), edges_with(Across::kRows, j)}; }
constexpr Wall layer_wall(int k) { return {{0, 0, k}, edges_with(Across::kLayers, 0), edges_with(Across::kLayers, k)}; }

bool ends(const CutLayer* layer) { return !layer || layer->beyond; }

// Whether nothing of the field lies on that side of a row.
bool ends_at(const Star& star, int j) {
  const auto edges = static_cast<EdgeMask>(star.there & row_wall(j).through);
  for (EdgeMask rest = edges; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
    if (star.value[static_cast<std::size_t>(std::countr_zero(rest))] != kFarOutside) return false;
  }
  return true;
}

}  // namespace

Walls::Walls(const CutLayer& layer, const CutLayer* below, const CutLayer* above, const CutSample& sample,
             const Star& star) {
  if (ends(below) || ends(above)) walls_[count_++] = layer_wall(ends(below) ? -1 : 1);
  const int from_end = layer.samples->rows - 1 - sample.row;
  if (sample.row == 0 || (sample.row == 1 && ends_at(star, -1))) {
    walls_[count_++] = row_wall(-1);
  } else if (from_end == 0 || (from_end == 1 && ends_at(star, 1))) {
    walls_[count_++] = row_wall(1);
  }
  if (sample.link != Link::kInner) {
    const LinkTable& link = link_table(sample.link);
    walls_[count_++] = {{sample.column == 0 ? -1 : 1, 0, 0}, link.in_face, edge_bit(link.beyond)};
  }
}

EdgeMask Walls::bound(EdgeMask cuts) const {
  for (const Wall& wall : *this) {
    if ((cuts & wall.within) != 0) {
      cuts = static_cast<EdgeMask>(cuts & wall.within);
    } else if ((cuts & wall.through) != 0) {
      cuts = static_cast<EdgeMask>(cuts & wall.through);
    }
  }
  return cuts;
}

}  // namespace fathom
