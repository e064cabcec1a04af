#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "registration/frame_geometry.h"

namespace fathom {

/// A straight row of a picture's pixels in space; reference coordinates, mm.
struct ResliceRow {
  Eigen::Vector3d start_mm = Eigen::Vector3d::Zero();  ///< centre of the first pixel
  Eigen::Vector3d step_mm = Eigen::Vector3d::UnitX();  ///< from a pixel to the next
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< of the picture here: unit vector
};

/// Where the pixels of a picture lie in space: a plane, or any other surface made of straight rows.
struct ResliceSurface {
  static constexpr double kMaxPixels = 1 << 26;
  static constexpr double kFarthest_mm = 1e7;  ///< from the origin: farther, pixels would be lost by rounding

  int columns = 1;  ///< pixels of every row
  std::vector<ResliceRow> rows;
  double spacing_mm = 1.0;  ///< of pixels, along rows and from row to row
  bool turned = false;      ///< the picture shows rows as columns, the first on the left

  /// Throws Error where there are no pixels or more than kMaxPixels, or a place is not finite or too far.
  void check() const;
  cv::Size picture_size() const;
};

/// A plane picture.
struct ReslicePlane {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  ///< centre of the top left pixel
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();    ///< to the right; any length above 0
  Eigen::Vector3d y_axis = Eigen::Vector3d::UnitY();    ///< down; any length above 0
  cv::Size size{1, 1};                                  ///< pixels
  double spacing_mm = 1.0;
};

/// Throws Error when the axes have no direction or are not perpendicular to 0.01 rad (within that, y is turned), and
/// as ResliceSurface::check.
ResliceSurface plane_surface(const ReslicePlane& plane);

/// How many pixels of a spacing a length takes: at least one. Throws Error for more than ResliceSurface::kMaxPixels.
int pixels_along(double length_mm, double spacing_mm);

/// The plane through the middle of a frame, turned by `turn_rad` about the image's vertical axis through it: 0 is the
/// frame's own plane, and a quarter turn looks along the sweep. Positive turns take image x towards image x cross y.
/// Without `size` the picture reaches over all `frames`. Throws Error as plane_surface.
ReslicePlane plane_through(const PlacedFrame& frame, double turn_rad, const std::vector<PlacedFrame>& frames,
                           cv::Size image_size, double spacing_mm, const cv::Size* size = nullptr);

/// A curved picture: a line through `points_mm` swept along a direction, flattened. The line runs to the right and the
/// direction down, over `height_mm` from the points on. Only the points' places across the direction count; they are
/// taken at the level of the first. Throws Error for fewer than two points, points that coincide, a direction without
/// length, and as ResliceSurface::check.
ResliceSurface curved_surface(const std::vector<Eigen::Vector3d>& points_mm, const Eigen::Vector3d& direction,
                              double height_mm, double spacing_mm);

/// A picture that follows the probe: from left to right along the way of the images' middles, downward along one image
/// column (`column_px`, as in ResliceSurface a pixel's centre is a whole number) of each frame. Frames nearer than
/// `knot_mm` to the last that was used are passed over, so that a trembling hand does not fold the picture. Throws
/// Error when the probe moved less than that, and as ResliceSurface::check.
ResliceSurface panorama_surface(const std::vector<PlacedFrame>& frames, cv::Size image_size, double column_px,
                                double spacing_mm, double knot_mm = 1.0);

}  // namespace fathom
