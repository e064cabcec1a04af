#include "measurement/plane_match.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "surface/cap_overlap.h"

namespace fathom {

namespace {

struct Side {
  std::vector<const ClippedMesh*> parts;
  double area_mm2 = 0.0;
};

}  // namespace

double PlaneMatch::mismatch_share() const {
  const double larger = std::max(std::abs(above_mm2), std::abs(below_mm2));
  return larger > 0.0 ? mismatch_mm2 / larger : 0.0;
}

bool is_above(const ConvexPart& part, std::size_t plane, const SpacePartition& partition) {
  const auto found = std::find(part.planes.begin(), part.planes.end(), plane);
  assert(found != part.planes.end());
  const auto at = static_cast<std::size_t>(found - part.planes.begin());
  return part.bounds[at].normal().dot(partition.planes()[plane].normal()) > 0.0;
}

std::vector<PlaneMatch> match_planes(std::span<const FilledPart> parts, const SpacePartition& partition) {
  std::vector<PlaneMatch> matches;
  for (std::size_t plane = 0; plane < partition.planes().size(); ++plane) {
    const int cap = static_cast<int>(plane);
    Side above;
    Side below;
    for (const FilledPart& part : parts) {
      const auto& of = part.closed.plane_of;
      if (std::find(of.begin(), of.end(), cap) == of.end()) continue;
      Side& side = is_above(part.space, plane, partition) ? above : below;
      side.parts.push_back(&part.closed);
      side.area_mm2 += cap_area_mm2(part.closed, cap);
    }
    if (above.parts.empty() && below.parts.empty()) continue;
    double common_mm2 = 0.0;
    for (const ClippedMesh* first : above.parts) {
      for (const ClippedMesh* second : below.parts) {
        common_mm2 += cap_overlap_mm2(*first, cap, *second, cap, partition.planes()[plane].normal());
      }
    }
    const double mismatch_mm2 = std::max(0.0, above.area_mm2 + below.area_mm2 - 2.0 * common_mm2);
    matches.push_back({plane, above.area_mm2, below.area_mm2, mismatch_mm2});
  }
  return matches;
}

}  // namespace fathom
