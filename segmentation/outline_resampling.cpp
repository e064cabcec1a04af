#include "segmentation/outline_resampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fathom {

double perimeter(const Polygon& outline) {
  double length = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) length += (outline[(i + 1) % outline.size()] - outline[i]).norm();
  return length;
}

Polygon resampled(const Polygon& outline, double spacing_px, int least) {
  const double length = perimeter(outline);
  if (!(length > 0.0)) return outline;
  const double count = std::max(static_cast<double>(least), std::round(length / spacing_px));
  const double spacing = length / count;
  Polygon points;
  double passed = 0.0;  // along the outline, up to the edge's start
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const double size = edge.norm();
    while (static_cast<double>(points.size()) < count) {
      const double at = spacing * static_cast<double>(points.size()) - passed;
      if (at > size || !(size > 0.0)) break;
      points.push_back(outline[i] + at / size * edge);
    }
    passed += size;
  }
  return points;
}

Polygon smoothed(Polygon outline, int passes) {
  const std::size_t count = outline.size();
  for (int pass = 0; pass < passes; ++pass) {
    const Polygon before = outline;
    for (std::size_t i = 0; i < count; ++i) {
      outline[i] = 0.25 * before[(i + count - 1) % count] + 0.5 * before[i] + 0.25 * before[(i + 1) % count];
    }
  }
  return outline;
}

}  // namespace fathom
