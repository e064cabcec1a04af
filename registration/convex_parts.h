#pragma once

#include <cstddef>
#include <vector>

#include "registration/partition.h"

namespace fathom {

/// Cells of a partition that use the same sweep and together are convex.
struct ConvexPart {
  std::size_t sweep = 0;
  std::size_t region = 0;             ///< as SpacePartition::Cell::region
  std::vector<std::size_t> planes;    ///< of the partition, ascending: those that bound this part
  std::vector<DividingPlane> bounds;  ///< the same, turned so that the part is on their positive side
};

/// Space in convex parts that have no point in common, fewer than the cells: a cell is joined with those beyond a plane
/// where all of them use its sweep. By ascending `sides` of their first cell. Cells without a sweep are left out.
std::vector<ConvexPart> convex_parts(const SpacePartition& partition);

}  // namespace fathom
