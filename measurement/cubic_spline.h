#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "measurement/planimetry.h"

namespace fathom {

/// A curve in D dimensions for t in [0, 1]: the sum of coefficient[k] t^k.
template <int D>
using Cubic = std::array<Eigen::Matrix<double, D, 1>, 4>;

/// The Catmull-Rom curve from p2 (t = 0) to p3 (t = 1). Treece 2000, equation (2.7).
template <int D>
Cubic<D> catmull_rom(const Eigen::Matrix<double, D, 1>& p1, const Eigen::Matrix<double, D, 1>& p2,
                     const Eigen::Matrix<double, D, 1>& p3, const Eigen::Matrix<double, D, 1>& p4) {
  return {p2, 0.5 * (p3 - p1), p1 - 2.5 * p2 + 2.0 * p3 - 0.5 * p4, 0.5 * (p4 - p1) + 1.5 * (p2 - p3)};
}

/// The integral of s . d(omega) over t in [0, 1], in closed form. Treece 2000, equations (B.2) to (B.5), in any number
/// of dimensions: Catmull-Rom is linear in its points, so curves through the ends of the lines of figure 2.2 give
/// the same as curves through their vector areas and centres.
template <int D>
double swept_volume(const Cubic<D>& s, const Cubic<D>& omega) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 1; k < 4; ++k) {
      sum += s[i].dot(omega[k]) * static_cast<double>(k) / static_cast<double>(i + k);
    }
  }
  return sum;
}

/// The curve from point `i` to point `i + 1` of a row of at least two.
template <int D>
Cubic<D> spline_segment(const std::vector<Eigen::Matrix<double, D, 1>>& points, std::size_t i, SplineEnd end) {
  using Point = Eigen::Matrix<double, D, 1>;
  assert(i + 1 < points.size());
  const Point& p2 = points[i];
  const Point& p3 = points[i + 1];
  const bool first = i == 0;
  const bool last = i + 2 == points.size();
  // Two points have no curvature to continue.
  const bool repeat = end == SplineEnd::kRepeat || (first && last);
  const Point p1 = !first ? points[i - 1] : repeat ? p3 : Point(3.0 * p2 - 3.0 * p3 + points[i + 2]);
  const Point p4 = !last ? points[i + 2] : repeat ? p2 : Point(3.0 * p3 - 3.0 * p2 + points[i - 1]);
  return catmull_rom<D>(p1, p2, p3, p4);
}

/// The integral of s . d(omega) along the splines through two rows of as many points, at least two. Signed.
template <int D>
double swept_volume(const std::vector<Eigen::Matrix<double, D, 1>>& s,
                    const std::vector<Eigen::Matrix<double, D, 1>>& omega, SplineEnd end) {
  assert(s.size() == omega.size() && s.size() >= 2);
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    sum += swept_volume<D>(spline_segment<D>(s, i, end), spline_segment<D>(omega, i, end));
  }
  return sum;
}

}  // namespace fathom
