#pragma once

#include <span>
#include <vector>

#include "measurement/section_outline.h"
#include "registration/partition.h"

namespace fathom {

/// What a region of a partition loses because the sections in it do not reach its dividing planes.
struct PartitionLoss {
  double gap_mm = 0.0;      ///< from a section to the plane, the largest at either end
  double missing_ml = 0.0;  ///< estimate of the structure's part in between
  bool first_cut = false;   ///< the first section in the region ends at a plane, not at the end of the structure
  bool last_cut = false;
};

/// The estimate carries the end section on to the plane, along its normal: with the area between it and the next
/// section where there is one beyond the plane; else growing or shrinking as it did from the one before. Nothing is
/// missing where the structure would have ended before the plane, or where it is marked as `absent` (frames) beyond
/// the last section. `clipped` comes from clip_each.
PartitionLoss estimate_loss(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                            std::span<const int> absent, const SpacePartition& partition, std::size_t region);

}  // namespace fathom
