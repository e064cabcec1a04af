#include "surface/star.h"

namespace fathom {

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
  const Link link = layer_.link(row, column);
  if (link != Link::kInner) set_side(link, star);
  return star;
}

void Stars::set_side(Link link, Star& star) const {
  const LinkTable& table = link_table(link);
  for (int e = 0; e < kLatticeEdges; ++e) {
    if (has_edge(table.edges, e) && e != table.beyond) continue;
    star.value[static_cast<std::size_t>(e)] = star.centre;
    star.there = static_cast<EdgeMask>(star.there & ~edge_bit(e));
  }
  if (layer_.capped_sides) {
    star.value[static_cast<std::size_t>(table.beyond)] = kFarOutside;
    star.there |= edge_bit(table.beyond);
  }
}

}  // namespace fathom
