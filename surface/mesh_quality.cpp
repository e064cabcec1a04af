#include "surface/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"

namespace fathom {

namespace {

// Height over longest side. Vertices at 10 m from the origin are rounded to 2e-12 mm: below this a triangle is a line.
constexpr double kNoHeight = 1e-12;

constexpr double kPoor = 2.0;  // radius ratio

// The smallest value that at least `share` of the values do not exceed.
double percentile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace

TriangleQuality triangle_quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Vector3d shortest = b - a;
  Eigen::Vector3d middle = c - b;
  Eigen::Vector3d longest = a - c;
  if (shortest.squaredNorm() > middle.squaredNorm()) shortest.swap(middle);
  if (middle.squaredNorm() > longest.squaredNorm()) middle.swap(longest);
  if (shortest.squaredNorm() > middle.squaredNorm()) shortest.swap(middle);
  const double short_mm = shortest.norm();
  const double middle_mm = middle.norm();
  const double long_mm = longest.norm();

  TriangleQuality quality;
  const double twice_area = shortest.cross(middle).norm();  // of the short sides, for precision
  if (!(twice_area > kNoHeight * long_mm * long_mm)) {
    quality.radius_ratio = std::numeric_limits<double>::infinity();
    quality.q_area = 0.0;
    quality.largest_angle_rad = std::numbers::pi;
    return quality;
  }
  quality.area_mm2 = 0.5 * twice_area;
  // R = l m n / (4 A) and r = 2 A / (l + m + n).
  quality.radius_ratio =
      short_mm * middle_mm * long_mm * (short_mm + middle_mm + long_mm) / (4.0 * twice_area * twice_area);
  quality.smallest_angle_rad = std::atan2(twice_area, std::abs(middle.dot(longest)));
  quality.largest_angle_rad = std::atan2(twice_area, -shortest.dot(middle));
  quality.q_area =
      2.0 * std::numbers::sqrt3 * twice_area / (short_mm * short_mm + middle_mm * middle_mm + long_mm * long_mm);
  return quality;
}

MeshQuality mesh_quality(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error("the surface has no triangles, so they have no quality");
  const std::size_t count = mesh.triangles.size();
  std::vector<double> ratios;
  std::vector<double> q_areas;
  ratios.reserve(count);
  q_areas.reserve(count);
  MeshQuality result;
  result.smallest_angle_rad = std::numbers::pi;
  double q_area_sum = 0.0;
  int poor = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const TriangleQuality quality =
        triangle_quality(mesh.vertices[static_cast<std::size_t>(a)], mesh.vertices[static_cast<std::size_t>(b)],
                         mesh.vertices[static_cast<std::size_t>(c)]);
    ratios.push_back(quality.radius_ratio);
    q_areas.push_back(quality.q_area);
    q_area_sum += quality.q_area;
    if (quality.radius_ratio > kPoor) ++poor;
    if (quality.area_mm2 == 0.0) ++result.zero_area_triangles;
    result.smallest_angle_rad = std::min(result.smallest_angle_rad, quality.smallest_angle_rad);
    result.largest_angle_rad = std::max(result.largest_angle_rad, quality.largest_angle_rad);
  }
  result.above_2 = static_cast<double>(poor) / static_cast<double>(count);
  result.radius_ratio_median = percentile(ratios, 0.5);
  result.radius_ratio_p95 = percentile(ratios, 0.95);
  result.radius_ratio_max = *std::max_element(ratios.begin(), ratios.end());
  result.q_area_p5 = percentile(q_areas, 0.05);
  result.q_area_median = percentile(q_areas, 0.5);
  result.q_area_mean = q_area_sum / static_cast<double>(count);
  return result;
}

}  // namespace fathom
