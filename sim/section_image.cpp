#include <algorithm>
#include <cmath>

#include "sim/section.h"

namespace fathom {

cv::Mat section_image(const Solid& solid, const Eigen::Affine3d& solid_from_image, cv::Size size) {
  cv::Mat image(size, CV_8UC1, cv::Scalar(0));
  const Eigen::Vector3d right = solid_from_image.linear().col(0);
  const Eigen::Vector3d down = solid_from_image.linear().col(1);
  const double step_mm = right.norm();
  const double reach_mm = solid.radius_mm() + step_mm;
  for (int y = 0; y < size.height; ++y) {
    const Eigen::Vector3d start = solid_from_image.translation() + y * down;
    // Only the chord of the ball that holds the solid can be inside.
    const double middle = -start.dot(right) / (step_mm * step_mm);
    const double chord_squared = reach_mm * reach_mm - (start + middle * right).squaredNorm();
    if (chord_squared <= 0.0) continue;
    const double half_chord = std::sqrt(chord_squared) / step_mm;
    int x = static_cast<int>(std::clamp(std::floor(middle - half_chord), 0.0, static_cast<double>(size.width)));
    const int end = static_cast<int>(std::clamp(std::ceil(middle + half_chord), 0.0, static_cast<double>(size.width)));
    std::uint8_t* row = image.ptr<std::uint8_t>(y);
    while (x < end) {
      const double bound = solid.distance_bound_mm(start + x * right);
      // No surface within the bound: every pixel up to there is on the same side.
      const int same = 1 + static_cast<int>(std::min(std::abs(bound) / step_mm, static_cast<double>(end - x)));
      const int stop = std::min(end, x + same);
      if (bound <= 0.0) std::fill(row + x, row + stop, std::uint8_t{255});
      x = stop;
    }
  }
  return image;
}

}  // namespace fathom
