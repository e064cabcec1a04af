#pragma once

#include <limits>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// Which closed lines to keep of those that a threshold gives.
struct ThresholdOptions {
  double threshold = 127.5;                                ///< pixels at or above it are inside
  double upper = std::numeric_limits<double>::infinity();  ///< and at or below this
  double min_area_px = 4.0;   ///< smaller outlines and smaller holes are dropped as noise; 0 keeps all
  bool below = false;         ///< inside is what would be outside: below the threshold or above the upper one
  double smoothing_px = 0.0;  ///< standard deviation of a Gaussian that evens out speckle first

  /// Throws Error when a value is out of range or the upper threshold below the other.
  void check() const;
};

/// Outlines of the bright (or dark) parts of an image of one channel, at sub-pixel precision: where the grey value,
/// interpolated linearly between neighbouring pixels, crosses the threshold. Outer outlines and holes are all
/// returned, largest first; they do not cross, so even-odd filling gives the parts back. What touches the border of
/// the image is closed half a pixel outside of the outermost pixel centres.
/// Throws Error when the image has more than one channel.
std::vector<Polygon> threshold_outlines(const cv::Mat& image, const ThresholdOptions& options);

}  // namespace fathom
