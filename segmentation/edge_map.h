#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace fathom {

/// At which sizes edges are looked for.
struct EdgeMapOptions {
  /// Standard deviation of the finest of three Gaussians; the others are two and four times it. Empty: half of the size
  /// of the image's speckle (`speckle_size_px`), from 1 to 4.
  std::optional<double> scale_px;
  static constexpr double kMostScale_px = 50.0;

  /// Throws Error when the scale is not from 0.3 to 50.
  void check() const;
};

/// How large the grains of an image are: the geometric mean, over x and y, of the full width at half height of its
/// autocorrelation, what is larger than some 20 pixels left out. 1 where it has no grains; 10 at most.
double speckle_size_px(const cv::Mat& grey);

/// The edges of a B-scan, told from speckle. Log-compressed speckle is noise of the same strength everywhere, so the
/// gradients of the image, smoothed at three scales, are each divided by their noise and then averaged: the fine one
/// says where an edge lies, the coarse ones that it is one.
struct EdgeMap {
  cv::Mat gradient;       ///< CV_32FC2, of the image's size: from dark to bright, in standard deviations of its noise
  cv::Mat ridge;          ///< CV_8U: not 0 where the gradient is strongest along its own direction
  double scale_px = 0.0;  ///< of the finest Gaussian
  bool flat = true;       ///< the image is the same all over, so that it has no edges at all

  /// The gradient between pixels; that of the nearest pixel outside of the image.
  Eigen::Vector2d at(const Eigen::Vector2d& point_px) const;
};

/// Grey values of an image of 1 or 3 channels (RGB) as CV_32F. Throws Error when the image is empty, of another number
/// of channels, or holds values that are not finite.
cv::Mat grey_values(const cv::Mat& image);

/// The same map with fewer pixels: each is the mean of `factor` x `factor` of them, those at the right and lower border
/// of fewer.
EdgeMap coarser(const EdgeMap& map, int factor);

/// Throws Error as `grey_values` and EdgeMapOptions::check.
EdgeMap edge_map(const cv::Mat& image, const EdgeMapOptions& options = {});

}  // namespace fathom
