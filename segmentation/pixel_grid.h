#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// Square blocks of pixels that cover a part of an image plane, which may reach beyond the image.
struct PixelGrid {
  Eigen::Vector2i corner_px = Eigen::Vector2i::Zero();  ///< the first block's top-left pixel
  int step_px = 1;                                      ///< side of a block
  cv::Size size;                                        ///< blocks in a row, rows

  /// The middle of block (i, j), pixels.
  Eigen::Vector2d middle_px(double i, double j) const {
    const double half = (step_px - 1) / 2.0;
    return {corner_px.x() + i * step_px + half, corner_px.y() + j * step_px + half};
  }

  /// Where a pixel is, in blocks.
  Eigen::Vector2d in_blocks(const Eigen::Vector2d& x_px) const {
    return (x_px - middle_px(0.0, 0.0)) / static_cast<double>(step_px);
  }
};

/// Around outlines, `margin_px` on every side. Blocks are so large that a part of the outlines' mean size has some
/// eight of them across, 1 to 4 pixels. Throws Error when there are no outlines or they would need more than 4 million
/// blocks.
PixelGrid grid_around(std::span<const Polygon> outlines_px, double margin_px);

/// Mean grey of every block, CV_32FC1; colours are averaged. Beyond the image its border goes on.
cv::Mat block_means(const cv::Mat& image, const PixelGrid& grid);

/// 1 for blocks that lie wholly in an image of `size`, 0 for others, CV_32FC1.
cv::Mat blocks_seen(cv::Size size, const PixelGrid& grid);

/// Outlines of the blocks where `field` (CV_32FC1) is positive, interpolated between blocks, in pixels; they do not
/// cross, and those that enclose less than `min_area_px` are left out.
std::vector<Polygon> grid_outlines(const cv::Mat& field, const PixelGrid& grid, double min_area_px);

}  // namespace fathom
