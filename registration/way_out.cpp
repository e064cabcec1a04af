#include "registration/way_out.h"

namespace fathom {

std::optional<WayOut> way_out(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& way,
                              std::span<const DividingPlane> bounds) {
  constexpr double kParallel = 1e-3;  // cosine: a section that stands on the plane never reaches it
  std::optional<WayOut> first;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const double slope = bounds[i].normal().dot(way);
    if (slope > -kParallel) continue;
    const double way_mm = bounds[i].signedDistance(from_mm) / -slope;
    if (!first || way_mm < first->way_mm) first = WayOut{i, way_mm};
  }
  return first;
}

}  // namespace fathom
