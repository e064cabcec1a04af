#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// Which closed lines to keep of those that a threshold gives.
struct ThresholdOptions {
  double threshold = 127.5;  ///< pixels at or above it are inside
  double min_area_px = 4.0;  ///< smaller outlines and smaller holes are dropped as noise; 0 keeps all
  bool below = false;        ///< inside is below the threshold instead

  /// Throws Error when a value is not finite or negative.
  void check() const;
};

/// Outlines of the bright (or dark) parts of an image of one channel, at sub-pixel precision: where the grey value,
/// interpolated linearly between neighbouring pixels, crosses the threshold. Outer outlines and holes are all
/// returned, largest first; they do not cross, so even-odd filling gives the parts back. What touches the border of
/// the image is closed half a pixel outside of the outermost pixel centres.
/// Throws Error when the image has more than one channel.
std::vector<Polygon> threshold_outlines(const cv::Mat& image, const ThresholdOptions& options);

}  // namespace fathom
