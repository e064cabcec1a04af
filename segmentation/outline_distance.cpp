#include "segmentation/outline_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <opencv2/core.hpp>

#include "core/error.h"
#include "segmentation/outline_mask.h"
#include "segmentation/threshold.h"

namespace fathom {

namespace {

constexpr double kMostSamples = 1e8;

double squared_distance(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const double length = edge.squaredNorm();
  const double share = length > 0.0 ? std::clamp((point - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return (point - a - share * edge).squaredNorm();
}

DistanceField empty_field(const cv::Rect& window, double value) {
  DistanceField field;
  field.window = window;
  field.values = cv::Mat(window.height * field.samples, window.width * field.samples, CV_32F, cv::Scalar(value));
  return field;
}

// Lowers the field, of squared distances, to those from a piece of line, as far as `reach_px` from it.
void lower_to_piece(DistanceField& field, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double reach_px) {
  const auto index = [&](double px, int origin, int count) {
    return static_cast<int>(std::clamp((px - origin + 0.5) * field.samples - 0.5, 0.0, static_cast<double>(count)));
  };
  const Eigen::Vector2d low = a.cwiseMin(b).array() - reach_px;
  const Eigen::Vector2d high = a.cwiseMax(b).array() + reach_px + 1.0;
  const int right = index(high.x(), field.window.x, field.values.cols);
  const int bottom = index(high.y(), field.window.y, field.values.rows);
  for (int row = index(low.y(), field.window.y, field.values.rows); row < bottom; ++row) {
    float* values = field.values.ptr<float>(row);
    for (int column = index(low.x(), field.window.x, field.values.cols); column < right; ++column) {
      const auto distance = static_cast<float>(squared_distance(field.place_px(column, row), a, b));
      values[column] = std::min(values[column], distance);
    }
  }
}

}  // namespace

cv::Rect window_around(std::span<const Polygon> outlines, Eigen::AlignedBox2d box, double margin_px) {
  for (const Polygon& outline : outlines) {
    for (const Eigen::Vector2d& point : outline) box.extend(point);
  }
  if (box.isEmpty()) return {};
  const Eigen::Vector2d low = (box.min().array() - margin_px).floor();
  const Eigen::Vector2d size = (box.max().array() + margin_px).ceil().matrix() - low + Eigen::Vector2d::Ones();
  if (!low.allFinite() || low.cwiseAbs().maxCoeff() > 1e9 || !(4.0 * size.x() * size.y() <= kMostSamples)) {
    throw Error("outlines: are too large to be edited; check the contours");
  }
  return {static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(size.x()), static_cast<int>(size.y())};
}

DistanceField signed_distance(std::span<const Polygon> outlines, const cv::Rect& window, double reach_px) {
  DistanceField field = empty_field(window, reach_px * reach_px);
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      lower_to_piece(field, outline[i], outline[(i + 1) % outline.size()], reach_px);
    }
  }
  cv::sqrt(field.values, field.values);
  const cv::Mat outside = outline_mask(outlines, window, field.samples) == 0;
  cv::Mat negative;
  field.values.convertTo(negative, CV_32F, -1.0);
  negative.copyTo(field.values, outside);
  return field;
}

DistanceField stroke_distance(std::span<const Eigen::Vector2d> line, double radius_px, const cv::Rect& window) {
  const double reach = radius_px + 2.0;
  DistanceField field = empty_field(window, reach * reach);
  for (std::size_t i = 0; i < line.size(); ++i) {
    lower_to_piece(field, line[i], line[std::min(i + 1, line.size() - 1)], reach);
  }
  cv::sqrt(field.values, field.values);
  field.values.convertTo(field.values, CV_32F, -1.0, radius_px);
  return field;
}

std::vector<Polygon> outlines_at(const DistanceField& field, double level_px, double least_area_px) {
  ThresholdOptions options;
  options.threshold = level_px;
  options.min_area_px = least_area_px * field.samples * field.samples;
  std::vector<Polygon> outlines = threshold_outlines(field.values, options);
  const Eigen::Vector2d origin = field.place_px(0, 0);
  for (Polygon& outline : outlines) {
    for (Eigen::Vector2d& point : outline) point = origin + point / field.samples;
  }
  return outlines;
}

}  // namespace fathom
