#include "measurement/predicted_outline.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

namespace fathom {

namespace {

constexpr int kStride = 2;  // blocks between the places that are interpolated: distances change slowly

/// A place between two sections, as SectionGap takes it.
struct Between {
  Eigen::Vector2d ab_mm;
  double u = 0.5;
};

/// Solves (1 - u) P1(a, b) + u P2(a, b) = x, from near the solution.
Between between_sections(const SectionGap& gap, const Eigen::Vector3d& x_mm, Between at) {
  const SectionPlane& first = gap.first().plane;
  const SectionPlane& second = gap.second().plane;
  for (int step = 0; step < 3; ++step) {
    const Eigen::Vector3d across = second.at(at.ab_mm) - first.at(at.ab_mm);
    const Eigen::Vector3d off = first.at(at.ab_mm) + at.u * across - x_mm;
    Eigen::Matrix3d slope;
    slope.col(0) = first.a_axis + at.u * (second.a_axis - first.a_axis);
    slope.col(1) = first.b_axis + at.u * (second.b_axis - first.b_axis);
    slope.col(2) = across;
    if (std::abs(slope.determinant()) < 1e-9) break;  // the planes meet here
    const Eigen::Vector3d move = slope.inverse() * off;
    at.ab_mm -= move.head<2>();
    at.u = std::clamp(at.u - move.z(), 0.0, 1.0);
    if (move.squaredNorm() < 1e-8) break;
  }
  return at;
}

float distance_or_absent(const SectionShape& shape, const Eigen::Vector2d& ab_mm, float absent_mm) {
  return shape.kind() == SectionKind::kAbsent ? -absent_mm : shape.distance_mm(ab_mm);
}

/// From every kStride-th block to all.
cv::Mat filled_in(const cv::Mat& coarse, cv::Size size) {
  const cv::Matx23d fine_to_coarse(1.0 / kStride, 0.0, 0.0, 0.0, 1.0 / kStride, 0.0);
  cv::Mat result;
  cv::warpAffine(coarse, result, fine_to_coarse, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return result;
}

cv::Size coarse_size(const PixelGrid& grid) {
  return {(grid.size.width + kStride - 1) / kStride + 1, (grid.size.height + kStride - 1) / kStride + 1};
}

TaperedEnd::Value value_between(const OutlineWays& ways, const Eigen::Vector2d& ab_mm, double u) {
  if (ways.first_ends != nullptr) return ways.first_ends->value_mm(ab_mm, 1.0 - u);
  if (ways.second_ends != nullptr) return ways.second_ends->value_mm(ab_mm, u);
  return {ways.across->value_mm(ab_mm, u), 0.0F};
}

}  // namespace

double block_mm(const CarriedPlane& place, const PixelGrid& grid) {
  return grid.step_px * std::sqrt(std::abs(place.ab_from_image.linear().determinant()));
}

PredictedOutline predict_outline(const SectionGap& gap, const OutlineWays& ways, const CarriedPlane& place,
                                 const PixelGrid& grid) {
  const SectionShape& first = *gap.first().shape;
  const SectionShape& second = *gap.second().shape;
  const float deepest = std::max(first.largest_inside_mm(), second.largest_inside_mm());
  const auto per_block = static_cast<float>(1.0 / block_mm(place, grid));
  const cv::Size size = coarse_size(grid);
  cv::Mat distance(size, CV_32FC1);
  cv::Mat change(size, CV_32FC1);
  cv::Mat depth(size, CV_32FC1);
  const bool ends = ways.first_ends != nullptr || ways.second_ends != nullptr;
  cv::Mat doubt(size, CV_32FC1);
  PredictedOutline result;
  double shares = 0.0;
  Between at;
  for (int j = 0; j < size.height; ++j) {
    for (int i = 0; i < size.width; ++i) {
      const Eigen::Vector2d own_ab = place.ab_from_image * grid.middle_px(kStride * i, kStride * j);
      at = between_sections(gap, place.plane.at(own_ab), {own_ab, at.u});
      shares += at.u;
      const TaperedEnd::Value value = value_between(ways, at.ab_mm, at.u);
      distance.at<float>(j, i) = per_block * value.distance_mm;
      doubt.at<float>(j, i) = per_block * value.doubt_mm;
      const float of_first = per_block * distance_or_absent(first, at.ab_mm, deepest);
      const float of_second = per_block * distance_or_absent(second, at.ab_mm, deepest);
      change.at<float>(j, i) = std::abs(of_second - of_first);
      depth.at<float>(j, i) = std::max(of_first, of_second);
    }
  }
  result.distance = filled_in(distance, grid.size);
  result.change = filled_in(change, grid.size);
  result.depth = filled_in(depth, grid.size);
  if (ends) result.doubt = filled_in(doubt, grid.size);
  result.share = shares / static_cast<double>(size.area());
  return result;
}

cv::Mat section_distances(const SectionShape& shape, const CarriedPlane& place, const PixelGrid& grid,
                          double absent_blocks) {
  cv::Mat distance(grid.size, CV_32FC1, cv::Scalar(-absent_blocks));
  if (shape.kind() == SectionKind::kAbsent) return distance;
  const auto per_block = static_cast<float>(1.0 / block_mm(place, grid));
  for (int j = 0; j < grid.size.height; ++j) {
    for (int i = 0; i < grid.size.width; ++i) {
      distance.at<float>(j, i) = per_block * shape.distance_mm(place.ab_from_image * grid.middle_px(i, j));
    }
  }
  return distance;
}

}  // namespace fathom
