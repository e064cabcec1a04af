#pragma once

#include <cstdint>

#include "core/random.h"

namespace fathom {

/// What of a simulated scan is random. Each has numbers of its own.
enum class Stream : std::uint64_t {
  kJitter = 1,
  kMisregistration = 2,
  kNoise = 3,
  kOutliers = 4,
  kBlunders = 5,
  kDropouts = 6,
  kHand = 7
};

inline Random random_stream(std::uint64_t seed, Stream stream) {
  constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15u;  // 2^64 / golden ratio: far apart for neighbouring streams
  return Random(seed ^ (static_cast<std::uint64_t>(stream) * kSpread));
}

}  // namespace fathom
