#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// Distances to outlines, sampled in a window of an image: what a brush, an offset and a clean-up are made from.
struct DistanceField {
  cv::Rect window;  ///< in pixels
  int samples = 2;  ///< a pixel and direction
  cv::Mat values;   ///< CV_32F, in pixels, positive inside; no farther from 0 than the reach it was made with

  Eigen::Vector2d place_px(int column, int row) const {
    return {window.x + (column + 0.5) / samples - 0.5, window.y + (row + 0.5) / samples - 0.5};
  }
};

/// The window that holds outlines (and a box), with so many pixels around. Throws Error when it has more than 1e8
/// samples of half a pixel.
cv::Rect window_around(std::span<const Polygon> outlines, Eigen::AlignedBox2d box, double margin_px);

/// Distances to what outlines enclose by even-odd. They must not cross.
DistanceField signed_distance(std::span<const Polygon> outlines, const cv::Rect& window, double reach_px);

/// Distances to a line, positive within `radius_px` of it.
DistanceField stroke_distance(std::span<const Eigen::Vector2d> line, double radius_px, const cv::Rect& window);

/// Where a field is `level`, as outlines: those that enclose at least `least_area_px`, largest first. They do not
/// cross, and lie within 0.05 pixels of the interpolated field's.
std::vector<Polygon> outlines_at(const DistanceField& field, double level_px, double least_area_px);

}  // namespace fathom
