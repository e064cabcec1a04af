#include "segmentation/push_contour.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

// How far the nearest point of the way from a to b is from a point.
double distance_to(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double length2 = way.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp((point - a).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (a + along * way - point).norm();
}

// The same line, with more points where it passes through the brush.
Polygon refined(const Polygon& points, const Eigen::Vector2d& centre, double radius, bool closed) {
  Polygon result;
  const double step = 0.25 * radius;
  const std::size_t ways = closed ? points.size() : points.size() - 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.push_back(points[i]);
    if (i >= ways) continue;
    const Eigen::Vector2d& next = points[(i + 1) % points.size()];
    const double length = (next - points[i]).norm();
    if (length <= step || distance_to(centre, points[i], next) >= radius) continue;
    const auto parts = static_cast<int>(std::ceil(length / step));
    for (int k = 1; k < parts; ++k) result.push_back(points[i] + (next - points[i]) * (static_cast<double>(k) / parts));
  }
  return result;
}

}  // namespace

bool push_contour(const Eigen::Vector2d& centre_px, double radius_px, bool closed, Polygon& points_px) {
  if (points_px.size() < 2) return false;
  Polygon pushed = refined(points_px, centre_px, radius_px, closed);
  bool touched = false;
  for (Eigen::Vector2d& point : pushed) {
    const Eigen::Vector2d outward = point - centre_px;
    const double distance = outward.norm();
    // At the very centre no way leads out; the next move of the brush finds one.
    if (distance >= radius_px || distance == 0.0) continue;
    point = centre_px + outward * (radius_px / distance);
    touched = true;
  }
  if (touched) points_px = std::move(pushed);
  return touched;
}

}  // namespace fathom
