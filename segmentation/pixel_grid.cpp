#include "segmentation/pixel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "segmentation/threshold.h"

namespace fathom {

namespace {

constexpr double kBlocksAcross = 8.0;
constexpr int kLargestStep_px = 4;
constexpr double kMostBlocks = 4.0e6;

double polygon_area_px(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(sum) / 2.0;
}

}  // namespace

PixelGrid grid_around(std::span<const Polygon> outlines_px, double margin_px) {
  Eigen::AlignedBox2d box;
  double smallest_px2 = std::numeric_limits<double>::infinity();
  double largest_px2 = 0.0;
  for (const Polygon& outline : outlines_px) {
    for (const Eigen::Vector2d& point : outline) box.extend(point);
    smallest_px2 = std::min(smallest_px2, polygon_area_px(outline));
    largest_px2 = std::max(largest_px2, polygon_area_px(outline));
  }
  if (box.isEmpty()) throw Error("propagation needs outlines, and there are none");
  // Specks beside a large part do not count.
  const double typical_px = std::sqrt(std::max(smallest_px2, 0.02 * largest_px2));
  PixelGrid grid;
  grid.step_px = std::clamp(static_cast<int>(typical_px / kBlocksAcross), 1, kLargestStep_px);
  const Eigen::Vector2d low = box.min().array() - margin_px;
  const Eigen::Vector2d extent = box.sizes().array() + 2.0 * margin_px;
  if (extent.x() * extent.y() > kMostBlocks * grid.step_px * grid.step_px) {
    throw Error("propagation: outlines " + std::to_string(std::lround(box.sizes().maxCoeff())) +
                " pixels across are too large; were they drawn on another recording?");
  }
  grid.corner_px = low.array().floor().cast<int>();
  grid.size.width = static_cast<int>(std::ceil(extent.x() / grid.step_px)) + 1;
  grid.size.height = static_cast<int>(std::ceil(extent.y() / grid.step_px)) + 1;
  return grid;
}

cv::Mat block_means(const cv::Mat& image, const PixelGrid& grid) {
  cv::Mat grey = image;
  if (image.channels() > 1) {
    std::vector<cv::Mat> planes;
    cv::split(image, planes);
    grey = cv::Mat::zeros(image.size(), CV_32FC1);
    for (const cv::Mat& plane : planes) cv::accumulate(plane, grey);
    grey /= static_cast<double>(planes.size());
  }
  grey.convertTo(grey, CV_32F);
  const cv::Rect wanted(grid.corner_px.x(), grid.corner_px.y(), grid.size.width * grid.step_px,
                        grid.size.height * grid.step_px);
  const cv::Rect inside = wanted & cv::Rect(0, 0, image.cols, image.rows);
  cv::Mat result(grid.size, CV_32FC1, cv::Scalar(0));
  if (inside.empty()) return result;
  cv::Mat part;
  cv::copyMakeBorder(grey(inside), part, inside.y - wanted.y, wanted.br().y - inside.br().y, inside.x - wanted.x,
                     wanted.br().x - inside.br().x, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  cv::resize(part, result, grid.size, 0.0, 0.0, cv::INTER_AREA);
  return result;
}

cv::Mat blocks_seen(cv::Size size, const PixelGrid& grid) {
  cv::Mat seen(grid.size, CV_32FC1, cv::Scalar(0));
  for (int j = 0; j < grid.size.height; ++j) {
    const int top = grid.corner_px.y() + j * grid.step_px;
    if (top < 0 || top + grid.step_px > size.height) continue;
    for (int i = 0; i < grid.size.width; ++i) {
      const int left = grid.corner_px.x() + i * grid.step_px;
      if (left >= 0 && left + grid.step_px <= size.width) seen.at<float>(j, i) = 1.0F;
    }
  }
  return seen;
}

std::vector<Polygon> grid_outlines(const cv::Mat& field, const PixelGrid& grid, double min_area_px) {
  ThresholdOptions options;
  options.threshold = 0.0;
  options.min_area_px = min_area_px / (grid.step_px * grid.step_px);
  std::vector<Polygon> outlines = threshold_outlines(field, options);
  for (Polygon& outline : outlines) {
    for (Eigen::Vector2d& point : outline) point = grid.middle_px(point.x(), point.y());
  }
  return outlines;
}

}  // namespace fathom
