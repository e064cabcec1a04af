#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

namespace fathom {

// What one voxel has added up to, by the kinds of insertion and compounding.

// A sum of pixels and their number in one word, so that a run of pixels costs one addition: 40 bits hold 2^24 pixels
// of 16 bits.
constexpr int kCountBits = 24;
constexpr std::uint64_t kCountMask = (std::uint64_t{1} << kCountBits) - 1;
constexpr int kFractionBits = 8;  // of a weight along one axis
constexpr int kOne = 1 << kFractionBits;

struct MeanCell {
  std::uint64_t sum_and_count;
};
struct LatestCell {
  std::uint64_t sum_and_count;
  std::uint64_t frame;
};
struct MaxCell {
  std::uint32_t above;  // the value + 1; 0 is none
};
struct LinearMeanCell {
  std::uint64_t sum, weight;
};
struct LinearFrameCell {  // latest, and max
  std::uint64_t sum, weight;
  std::uint32_t frame, above;
};

inline std::uint32_t rounded(std::uint64_t sum, std::uint64_t weight) {
  return static_cast<std::uint32_t>((sum + weight / 2) / weight);
}

// The value + 1 of a cell; 0 where it has none.
inline std::uint32_t above(const MeanCell& cell) {
  const std::uint64_t count = cell.sum_and_count & kCountMask;
  return count == 0 ? 0 : rounded(cell.sum_and_count >> kCountBits, count) + 1;
}
inline std::uint32_t above(const LatestCell& cell) { return above(MeanCell{cell.sum_and_count}); }
inline std::uint32_t above(const MaxCell& cell) { return cell.above; }
inline std::uint32_t above(const LinearMeanCell& cell) {
  return cell.weight == 0 ? 0 : rounded(cell.sum, cell.weight) + 1;
}
inline std::uint32_t above(const LinearFrameCell& cell) {
  return std::max(cell.above, above(LinearMeanCell{cell.sum, cell.weight}));
}

inline std::uint64_t count_of(const MeanCell& cell) { return cell.sum_and_count & kCountMask; }
inline std::uint64_t count_of(const LatestCell& cell) { return cell.sum_and_count & kCountMask; }
inline std::uint64_t count_of(const MaxCell&) { return 0; }
inline std::uint64_t count_of(const LinearMeanCell& cell) { return cell.weight >> (3 * kFractionBits); }
inline std::uint64_t count_of(const LinearFrameCell& cell) { return cell.weight >> (3 * kFractionBits); }

template <typename Cell>
constexpr bool kIsLinear = std::is_same_v<Cell, LinearMeanCell> || std::is_same_v<Cell, LinearFrameCell>;

}  // namespace fathom
