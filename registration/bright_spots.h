#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace fathom {

/// A small bright mark in an image: the echo of a wire, or something that looks like one.
struct BrightSpot {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double contrast = 0.0;   ///< above its surroundings, averaged over the size of an echo, in grey levels
  double width_px = 0.0;   ///< of the part above half height
  double height_px = 0.0;  ///< of the part above half height
  bool cut_off = false;    ///< by the border of the image or of the scanned area: its centre is not known
};

struct BrightSpotOptions {
  int max_spots = 40;           ///< those of greatest contrast are kept
  double min_contrast = 0.02;   ///< of the largest value of the pixel type (of the image, for other than 8 or 16 bits)
  double min_prominence = 6.0;  ///< in robust standard deviations of the image's texture
  double max_size = 0.16;       ///< of the image's smaller side: what is wider or higher is a wall, not a spot
  double height_level = 0.3;    ///< share of the peak above the background down to which pixels belong to the spot
  /// Throws Error when a value is out of range.
  void check() const;
};

/// The largest value that the pixel type holds; of other types than 8 or 16 bits, the largest in the image.
double full_scale(const cv::Mat& image);

/// One channel of 32-bit floats, black at 0: what the detectors work on. Colours are averaged by luminance (RGB).
cv::Mat grey_image(const cv::Mat& image);

/// Spots of an image of any size and pixel type, in order of falling contrast. Backgrounds may be black or speckled.
///
/// A spot is a local maximum of (mean over a small wide window) - (mean over its surroundings). Its centre is the
/// centroid of the connected pixels above `height_level`, weighted by how far they exceed it, hence sub-pixel.
std::vector<BrightSpot> find_bright_spots(const cv::Mat& image, const BrightSpotOptions& options = {});

}  // namespace fathom
