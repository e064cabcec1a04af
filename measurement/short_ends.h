#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measurement/cross_section.h"
#include "registration/partition.h"
#include "segmentation/contours.h"

namespace fathom {

/// Where the outlines of a sweep end while the structure is still large, short of the dividing plane that they run up
/// to, so that what lies between is lost.
struct ShortEnd {
  int frame = 0;
  std::size_t plane = 0;
  double area_mm2 = 0.0;  ///< of the section
  double gap_mm = 0.0;    ///< along the section's normal
  /// The section carried on to the plane; empty where that is farther than the section is wide, and says nothing.
  std::optional<double> missing_ml;
};

/// `sections` are those of sweep `sweep`, in their order: its first and last are looked at, unless the structure is
/// marked `absent` beyond them.
std::vector<ShortEnd> short_ends(const std::vector<CrossSection>& sections, std::span<const AbsentMark> absent,
                                 std::size_t sweep, const SpacePartition& partition);

std::string warning_of(const ShortEnd& end, std::size_t sweep);

}  // namespace fathom
