#include "registration/convex_parts.h"

#include <algorithm>
#include <cstdint>

namespace fathom {

namespace {

// The cells that lie as `sides` where `mask` has a bit, wherever elsewhere.
std::vector<std::size_t> cells_within(const SpacePartition& partition, std::uint32_t sides, std::uint32_t mask) {
  std::vector<std::size_t> within;
  for (std::size_t i = 0; i < partition.cells().size(); ++i) {
    if (((partition.cells()[i].sides ^ sides) & mask) == 0) within.push_back(i);
  }
  return within;
}

}  // namespace

std::vector<ConvexPart> convex_parts(const SpacePartition& partition) {
  const std::vector<SpacePartition::Cell>& cells = partition.cells();
  std::vector<ConvexPart> parts;
  std::vector<bool> taken(cells.size(), false);
  for (std::size_t first = 0; first < cells.size(); ++first) {
    const SpacePartition::Cell& cell = cells[first];
    if (taken[first] || !cell.sweep) continue;
    // Leave out one plane after another, as long as what is then within uses the same sweep and is free.
    std::uint32_t mask = 0;
    for (std::size_t j = 0; j < partition.planes().size(); ++j) mask |= std::uint32_t{1} << j;
    for (std::size_t j = 0; j < partition.planes().size(); ++j) {
      const std::uint32_t wider = mask & ~(std::uint32_t{1} << j);
      const std::vector<std::size_t> within = cells_within(partition, cell.sides, wider);
      const bool may_join = std::all_of(within.begin(), within.end(),
                                        [&](std::size_t i) { return !taken[i] && cells[i].sweep == cell.sweep; });
      if (may_join) mask = wider;
    }
    for (const std::size_t i : cells_within(partition, cell.sides, mask)) taken[i] = true;
    ConvexPart part{*cell.sweep, cell.region, {}, {}};
    const std::vector<DividingPlane> bounds = partition.bounds(cell);
    for (std::size_t j = 0; j < bounds.size(); ++j) {
      if ((mask >> j & 1u) == 0) continue;
      part.planes.push_back(j);
      part.bounds.push_back(bounds[j]);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace fathom
