#pragma once

#include <cstddef>
#include <vector>

#include "acquisition/live/live_source.h"
#include "acquisition/live/polhemus_record.h"

namespace fathom {

/// How many of the readings sent between the first and the last sample that came did not come. Fails the test when a
/// valid sample was never sent, or not in this order.
std::size_t missing(const std::vector<TrackerSample>& samples, const std::vector<PolhemusReading>& sent);

}  // namespace fathom
