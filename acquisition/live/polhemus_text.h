#pragma once

#include "acquisition/live/polhemus_record.h"

namespace fathom {

/// read_polhemus for records of text. What is no whole line of exactly the numbers asked for is noise, up to its end.
PolhemusStep read_polhemus_line(std::span<const std::uint8_t> bytes, const PolhemusFormat& format);

}  // namespace fathom
