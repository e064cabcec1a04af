#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

#include "measurement/cubic_spline.h"
#include "measurement/planimetry.h"
#include "measurement/sweep_path.h"

namespace fathom {

namespace {

// Of the longest step. Frames nearer to each other than this would make tangents of nothing but noise.
constexpr double kShortestStep = 1e-3;

// The steps that the curve is drawn over: of the frames, where known, else of the centroids.
std::vector<double> steps_of(std::span<const CrossSection> sections) {
  std::vector<double> steps;
  const bool known = sections.back().along_mm > sections.front().along_mm;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    steps.push_back(known ? sections[i].along_mm - sections[i - 1].along_mm
                          : (sections[i].centroid_mm - sections[i - 1].centroid_mm).norm());
  }
  const double longest = *std::max_element(steps.begin(), steps.end());
  for (double& step : steps) step = longest > 0.0 ? std::max(step, kShortestStep * longest) : 1.0;
  return steps;
}

// Derivatives at the points: of the parabola through a point and its neighbours, at an end through the last three.
std::vector<Eigen::Vector3d> tangents(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& steps) {
  const std::size_t n = points.size();
  std::vector<Eigen::Vector3d> slopes;
  for (std::size_t i = 0; i + 1 < n; ++i) slopes.emplace_back((points[i + 1] - points[i]) / steps[i]);
  if (n == 2) return {slopes.front(), slopes.front()};
  std::vector<Eigen::Vector3d> result(n);
  const auto end = [&](std::size_t at, std::size_t next) -> Eigen::Vector3d {
    return slopes[at] + (slopes[at] - slopes[next]) * (steps[at] / (steps[at] + steps[next]));
  };
  result.front() = end(0, 1);
  result.back() = end(n - 2, n - 3);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    result[i] = (slopes[i - 1] * steps[i] + slopes[i] * steps[i - 1]) / (steps[i - 1] + steps[i]);
  }
  return result;
}

// The cubic from p to q over [0, 1] with these derivatives.
Cubic<3> hermite(const Eigen::Vector3d& p, const Eigen::Vector3d& dp, const Eigen::Vector3d& q,
                 const Eigen::Vector3d& dq) {
  return {p, dp, 3.0 * (q - p) - 2.0 * dp - dq, 2.0 * (p - q) + dp + dq};
}

}  // namespace

std::vector<GapVolumes> gap_volumes(std::span<const CrossSection> sections) {
  assert(sections.size() >= 2);
  std::vector<Eigen::Vector3d> s;
  std::vector<Eigen::Vector3d> omega;
  for (const CrossSection& section : sections) {
    s.push_back(section.vector_area_mm2);
    omega.push_back(section.centroid_mm - sections.front().centroid_mm);  // near the origin, for precision
  }
  const std::vector<double> steps = steps_of(sections);
  const std::vector<Eigen::Vector3d> ds = tangents(s, steps);
  const std::vector<Eigen::Vector3d> domega = tangents(omega, steps);
  std::vector<GapVolumes> gaps;
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    const double step = steps[i];
    gaps.push_back({0.5 * (s[i] + s[i + 1]).dot(omega[i + 1] - omega[i]),
                    swept_volume<3>(hermite(s[i], step * ds[i], s[i + 1], step * ds[i + 1]),
                                    hermite(omega[i], step * domega[i], omega[i + 1], step * domega[i + 1]))});
  }
  return gaps;
}

}  // namespace fathom
