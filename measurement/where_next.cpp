#include "measurement/where_next.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "measurement/planimetry.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
// Share of the difference between the two methods that is still unknown: the error of quadric planimetry in a gap,
// over simulated scans (docs/results.md).
constexpr double kUnknown = 0.25;
// Halves of a gap differ by an eighth each where the curve is of third order: the square falls by this.
constexpr double kSquareAfter = 2.0 / 64.0;

// The frame with a pose nearest to the middle between two; empty where there is none.
std::optional<int> middle_frame(int from, int to, const FrameLocator& locator) {
  const int middle = from + (to - from) / 2;
  for (int away = 0; away < to - from; ++away) {
    for (const int frame : {middle - away, middle + away}) {
      if (frame > from && frame < to && locator.reference_from_image(frame)) return frame;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<NextOutline> where_next(std::span<const CrossSection> sections, const FrameLocator& locator) {
  assert(sections.size() >= 2);
  std::vector<double> unknown;
  double squares = 0.0;
  for (const GapVolumes& gap : gap_volumes(sections)) {
    unknown.push_back(kUnknown * std::abs(gap.quadric_mm3 - gap.linear_mm3) / kMm3PerMl);
    squares += unknown.back() * unknown.back();
  }
  std::vector<std::size_t> order(unknown.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return unknown[a] > unknown[b]; });
  for (const std::size_t gap : order) {
    const auto frame = middle_frame(sections[gap].frame, sections[gap + 1].frame, locator);
    if (!frame) continue;
    const double after = squares - (1.0 - kSquareAfter) * unknown[gap] * unknown[gap];
    return NextOutline{*frame, std::sqrt(squares), std::sqrt(squares) - std::sqrt(std::max(0.0, after))};
  }
  return std::nullopt;
}

}  // namespace fathom
