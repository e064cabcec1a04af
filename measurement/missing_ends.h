#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measurement/cross_section.h"
#include "segmentation/contours.h"

namespace fathom {

/// What lies beyond the first or the last section of a structure, judged by how its sections grow or shrink towards
/// that end. An estimate, never added to a volume: an organ may also end in a flat face, or go on.
struct MissingEnd {
  int frame = 0;      ///< of the section at the end
  bool first = true;  ///< before the first section; else after the last
  /// The parabola through the areas at the end, at a sixth and at a third of the scan, down to its zero: exact for
  /// quadrics cut by parallel planes. Where it has none, a tip. Empty where the sections grow towards the end, or the
  /// zero lies farther off than half the scan: nothing can be said but that the organ is cut off.
  std::optional<double> volume_ml;
  double length_mm = 0.0;  ///< to that zero, along the normal
  double high_ml = 0.0;    ///< 95 %: from nothing, a flat face, to this, where the estimate exists
};

/// `sections` in scan order with finite values. At most one for each end; none where the section at the end is small
/// (2 % of the largest) or an extremity, nor with fewer than three sections. `absent`: frames on which the structure
/// was looked for and is not there; beyond them nothing is missing, so an estimate is cut off there. `locator` places
/// these frames; a mark without a pose is passed over.
std::vector<MissingEnd> missing_ends(std::span<const CrossSection> sections, std::span<const AbsentMark> absent,
                                     const FrameLocator& locator);

/// For the user: "about 3.1 ml (0 to 6.2) are missing beyond frame 12".
std::string warning_of(const MissingEnd& end);

}  // namespace fathom
