#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

namespace fathom {

/// What a curved probe shows of its image: the part of a ring between two angles.
struct Fan {
  Eigen::Vector2d origin_px = Eigen::Vector2d::Zero();  ///< where the scan lines meet; may lie outside of the image
  double min_radius_px = 0.0;                           ///< in heights of pixels
  double max_radius_px = 0.0;                           ///< in heights of pixels
  double min_angle_rad = 0.0;                           ///< from straight down, positive to the right; above -pi
  double max_angle_rad = 0.0;                           ///< below pi
  double pixel_aspect = 1.0;                            ///< width of a pixel by its height

  /// Throws Error unless 0 <= min_radius < max_radius, -pi < min_angle < max_angle < pi, and all is finite.
  void check() const;
  bool contains(double x_px, double y_px) const;
};

/// Pixels `first` to `end` - 1 of a row.
struct PixelSpan {
  int first = 0;
  int end = 0;
};

/// The pixels that are used, row by row; the spans of a row are in order and apart.
struct PixelArea {
  std::vector<std::vector<PixelSpan>> rows;

  bool contains(int x, int y) const;
};

/// The pixels within a rectangle, and within a fan where there is one. `clip` lies within the image; Throws Error as
/// Fan::check.
PixelArea pixel_area(cv::Size image_size, const cv::Rect& clip, const std::optional<Fan>& fan = {});

}  // namespace fathom
