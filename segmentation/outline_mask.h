#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// What outlines enclose (even-odd) in a window of an image: CV_8UC1, 255 where a sample lies inside, else 0. Each
/// pixel is divided into `samples` x `samples` parts, and their centres are looked at. Outlines may cross.
cv::Mat outline_mask(std::span<const Polygon> outlines, const cv::Rect& window, int samples = 1);

/// Whether a point lies inside of outlines, by even-odd.
bool encloses(std::span<const Polygon> outlines, const Eigen::Vector2d& point_px);

/// Twice the common area over the sum of both areas: 1 where both enclose the same, 0 where they have nothing in
/// common, 1 where both enclose nothing. Areas by `outline_mask` with 4 x 4 samples a pixel.
double dice(std::span<const Polygon> a, std::span<const Polygon> b);

}  // namespace fathom
