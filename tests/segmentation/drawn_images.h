#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "segmentation/contours.h"

namespace fathom {

/// A dark disc on bright ground, its edge a ramp of two pixels, so that it lies at the radius to a hundredth of a
/// pixel.
inline void draw_disc(cv::Mat& image, const Eigen::Vector2d& centre, double radius, double grey) {
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double inside = std::clamp(0.5 + 0.5 * (radius - std::hypot(x - centre.x(), y - centre.y())), 0.0, 1.0);
      float& value = image.at<float>(y, x);
      value = static_cast<float>((1.0 - inside) * value + inside * grey);
    }
  }
}

/// Speckle as after log compression: noise whose grains are some pixels large. CV_8UC1.
inline cv::Mat speckled(const cv::Mat& clean, double deviation, std::uint64_t seed) {
  Random random(seed);
  cv::Mat noise(clean.size(), CV_32F);
  for (int y = 0; y < noise.rows; ++y) {
    for (int x = 0; x < noise.cols; ++x) noise.at<float>(y, x) = static_cast<float>(random.normal());
  }
  cv::GaussianBlur(noise, noise, {}, 1.3, 0.8);
  const double factor = deviation * std::sqrt(4.0 * std::numbers::pi * 1.3 * 0.8);
  cv::Mat image;
  cv::Mat(clean + factor * noise).convertTo(image, CV_8U);
  return image;
}

inline Polygon circle(const Eigen::Vector2d& centre, double radius, int count) {
  Polygon points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    points.push_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return points;
}

}  // namespace fathom
