#pragma once

#include <optional>
#include <span>

#include "measurement/cross_section.h"

namespace fathom {

/// The frame whose outline would tell most about the volume.
struct NextOutline {
  int frame = 0;
  double now_ml = 0.0;   ///< how uncertain the volume is by what lies between sections: standard deviation
  double gain_ml = 0.0;  ///< what that is expected to become less by
};

/// Looks between the sections: a gap counts by what linear and quadric planimetry of it differ by, which is what its
/// middle decides. The frame is the middle one, by the way of the frames, of the gap that counts most, among those that
/// have a pose. `sections` are those of one sweep, in the order of their frames, at least two. Empty where no gap has
/// a frame left with a pose.
std::optional<NextOutline> where_next(std::span<const CrossSection> sections, const FrameLocator& locator);

}  // namespace fathom
