#pragma once

#include <optional>
#include <span>

#include "acquisition/live/live_source.h"

namespace fathom {

/// How much a tracker's poses move while the probe is held still: rms about a
/// steady drift over half a second.
struct TrackerJitter {
  double position_mm = 0.0;
  double angle_deg = 0.0;
  double still_s = 0.0;  ///< for how long it was held still in all
};

/// The jitter of one transform's samples, in order of time; poses that are not valid are passed over.
std::optional<TrackerJitter> tracker_jitter(std::span<const TrackerSample> samples);

}  // namespace fathom
