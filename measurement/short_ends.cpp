#include "measurement/short_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "registration/convex_parts.h"
#include "registration/way_out.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kLarge = 0.1;  // of the largest section: a structure does not end there

bool holds(const ConvexPart& part, const Eigen::Vector3d& point) {
  return std::all_of(part.bounds.begin(), part.bounds.end(),
                     [&point](const DividingPlane& bound) { return bound.signedDistance(point) >= 0.0; });
}

// Whether a mark lies beyond frame `end`, seen from frame `next`.
bool is_marked_beyond(std::span<const AbsentMark> absent, int end, int next) {
  return std::any_of(absent.begin(), absent.end(),
                     [&](const AbsentMark& mark) { return next > end ? mark.frame < end : mark.frame > end; });
}

}  // namespace

std::vector<ShortEnd> short_ends(const std::vector<CrossSection>& sections, std::span<const AbsentMark> absent,
                                 std::size_t sweep, const SpacePartition& partition) {
  std::vector<ShortEnd> ends;
  if (sections.size() < 2) return ends;
  double largest = 0.0;
  for (const CrossSection& section : sections) largest = std::max(largest, section.vector_area_mm2.norm());
  for (const auto& [end, next] :
       {std::pair(&sections.front(), &sections[1]), std::pair(&sections.back(), &sections[sections.size() - 2])}) {
    const double area_mm2 = end->vector_area_mm2.norm();
    if (area_mm2 < kLarge * largest || is_marked_beyond(absent, end->frame, next->frame)) continue;
    Eigen::Vector3d away = end->normal;
    if (away.dot(next->centroid_mm - end->centroid_mm) > 0.0) away = -away;
    for (const ConvexPart& part : convex_parts(partition)) {
      if (part.sweep != sweep || !holds(part, end->centroid_mm)) continue;
      const auto out = way_out(end->centroid_mm, away, part.bounds);
      if (!out) continue;
      ends.push_back({end->frame, part.planes[out->bound], area_mm2, out->way_mm, {}});
      if (out->way_mm <= std::sqrt(area_mm2)) ends.back().missing_ml = out->way_mm * area_mm2 / kMm3PerMl;
      break;
    }
  }
  return ends;
}

std::string warning_of(const ShortEnd& end, std::size_t sweep) {
  char text[240];
  const int length =
      std::snprintf(text, sizeof text, "the outlines of sweep %zu end on frame %d, %.2g mm short of dividing plane %zu",
                    sweep + 1, end.frame, end.gap_mm, end.plane + 1);
  char* rest = text + length;
  const std::size_t room = sizeof text - static_cast<std::size_t>(length);
  if (end.missing_ml) {
    std::snprintf(rest, room, ": about %.2g ml missing", *end.missing_ml);
  } else {
    std::snprintf(rest, room, ", where the structure is still %.3g mm2 large; outline it further", end.area_mm2);
  }
  return text;
}

}  // namespace fathom
