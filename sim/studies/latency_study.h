#pragma once

#include "sim/studies/study.h"

namespace fathom {

/// Study `latency`: how far off the delay between tracker and images is found from a probe that is moved up and down
/// over a floor, and whether it says so. A case is a noise of the tracker, with the floor's depth known to half a
/// pixel, its samples scans of 20 s with latencies within +-480 ms; or, a tenth as many, of 12 s with the floor found
/// in speckled images.
const Study& latency_study();

}  // namespace fathom
