#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include "registration/reslice.h"
#include "tests/registration/scans.h"

namespace fathom {

// Scans to be looked at from anywhere, and what is asked of the pictures.

inline constexpr int kFrames = 24;
inline const cv::Size kSize{53, 41};
inline const Eigen::Vector2d kPixel_mm(0.4, 0.3);

inline Sweep whole(const PlacedScan& scan) { return {0, 0, scan.locator->frame_count() - 1}; }

inline bool equal(const cv::Mat& a, const cv::Mat& b) {
  if (a.size != b.size || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (!std::equal(a.ptr(y), a.ptr(y) + a.cols * static_cast<int>(a.elemSize()), b.ptr(y))) return false;
  }
  return true;
}

inline double value(const cv::Mat& image, int x, int y) {
  switch (image.depth()) {
    case CV_8U:
      return image.at<std::uint8_t>(y, x);
    case CV_8S:
      return image.at<std::int8_t>(y, x);
    case CV_16U:
      return image.at<std::uint16_t>(y, x);
    default:
      return image.at<std::int16_t>(y, x);
  }
}

inline Eigen::Vector3d place(const ResliceSurface& surface, int x, int y) {
  const ResliceRow& row = surface.rows[static_cast<std::size_t>(surface.turned ? x : y)];
  return row.start_mm + (surface.turned ? y : x) * row.step_mm;
}

// Any plane near the middle of the sweep.
inline ReslicePlane random_plane(Random& random, double sweep_mm, int side = 64) {
  ReslicePlane plane;
  const Eigen::Matrix3d turn = random_pose(random).linear();
  plane.size = {side, side - 7};
  plane.spacing_mm = 0.37;
  plane.x_axis = turn.col(0);
  plane.y_axis = turn.col(1);
  plane.origin_mm = Eigen::Vector3d(10.0, 6.0, 0.5 * sweep_mm) -
                    0.5 * plane.spacing_mm * (plane.size.width * turn.col(0) + plane.size.height * turn.col(1));
  return plane;
}

inline double texture(int frame, const Eigen::Vector3d& at) {
  return 128.0 + 90.0 * std::sin(0.9 * at.x() + 0.5 * at.z() + frame) * std::cos(1.1 * at.y() - 0.7 * at.z());
}

}  // namespace fathom
