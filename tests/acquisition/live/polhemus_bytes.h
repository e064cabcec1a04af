#pragma once

#include <string>
#include <vector>

#include "acquisition/live/polhemus_record.h"
#include "core/random.h"

namespace fathom {

/// A reading as an instrument sends it.
std::string polhemus_bytes(const PolhemusReading& reading, const PolhemusFormat& format);

/// A sensor somewhere within half a metre of the source, turned anyhow.
PolhemusReading random_reading(Random& random, int station, std::uint32_t frame);

struct PolhemusFound {
  std::vector<PolhemusReading> readings;
  std::size_t noise = 0;  ///< bytes
  std::size_t left = 0;   ///< bytes at the end that may begin a record
};

/// All that `bytes` hold, when they come in pieces of `piece` bytes.
PolhemusFound find_all(const std::string& bytes, const PolhemusFormat& format, std::size_t piece = 1'000'000);

}  // namespace fathom
