#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// What a region grows through.
struct RegionOptions {
  double smoothing_px = 2.0;     ///< standard deviation of the Gaussian that evens out speckle first
  double tolerance = 2.5;        ///< standard deviations of the region's grey values that still belong to it
  std::optional<double> low;     ///< grey values of the smoothed image from here on, in place of the tolerance
  std::optional<double> high;    ///< and up to here
  double neck_px = 4.0;          ///< does not grow through gaps narrower than this; 0: through all
  double fill_holes_px = 200.0;  ///< smaller holes are filled; area in square pixels

  /// Throws Error when a value is out of range.
  void check() const;
};

/// Outlines of the connected part of an image around seeds whose grey values are like theirs. The region learns its
/// mean and spread as it grows; its border is put where the grey value is half way to what lies around it, between
/// pixels. Outer outlines and holes, largest first; they do not cross.
/// Throws Error when a seed is outside of the image or there is none; when the values at the seeds are out of the range
/// asked for; when the region is nearly all of the image, so that it has no border; and as `grey_values`.
std::vector<Polygon> grow_region(const cv::Mat& image, std::span<const Eigen::Vector2d> seeds_px,
                                 const RegionOptions& options = {});

}  // namespace fathom
