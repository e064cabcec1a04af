#include "measurement/short_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "registration/convex_parts.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kLarge = 0.1;      // of the largest section: a structure does not end there
constexpr double kParallel = 1e-3;  // cosine: a section that stands on the plane never reaches it

struct Hit {
  std::size_t plane = 0;
  double way_mm = 0.0;
};

// Where the way from a point leaves the part of space that it is in.
std::optional<Hit> first_plane(const Eigen::Vector3d& from, const Eigen::Vector3d& way, const ConvexPart& part) {
  std::optional<Hit> first;
  for (std::size_t i = 0; i < part.bounds.size(); ++i) {
    const double distance_mm = part.bounds[i].signedDistance(from);
    const double slope = part.bounds[i].normal().dot(way);
    if (distance_mm < 0.0) return {};
    if (slope > -kParallel) continue;
    if (!first || distance_mm / -slope < first->way_mm) first = Hit{part.planes[i], distance_mm / -slope};
  }
  return first;
}

}  // namespace

std::vector<ShortEnd> short_ends(const std::vector<CrossSection>& sections, std::size_t sweep,
                                 const SpacePartition& partition) {
  std::vector<ShortEnd> ends;
  if (sections.size() < 2) return ends;
  double largest = 0.0;
  for (const CrossSection& section : sections) largest = std::max(largest, section.vector_area_mm2.norm());
  for (const auto& [end, next] :
       {std::pair(&sections.front(), &sections[1]), std::pair(&sections.back(), &sections[sections.size() - 2])}) {
    const double area_mm2 = end->vector_area_mm2.norm();
    if (area_mm2 < kLarge * largest) continue;
    Eigen::Vector3d away = end->normal;
    if (away.dot(next->centroid_mm - end->centroid_mm) > 0.0) away = -away;
    for (const ConvexPart& part : convex_parts(partition)) {
      if (part.sweep != sweep) continue;
      const auto hit = first_plane(end->centroid_mm, away, part);
      if (!hit) continue;
      ends.push_back({end->frame, hit->plane, area_mm2, hit->way_mm, {}});
      if (hit->way_mm <= std::sqrt(area_mm2)) ends.back().missing_ml = hit->way_mm * area_mm2 / kMm3PerMl;
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
