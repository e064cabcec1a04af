#include "segmentation/outline_mask.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace fathom {

namespace {

constexpr int kDiceSamples = 4;
constexpr double kLongestSide = 8000.0;  // pixels of a mask for Dice; larger outlines are sampled more coarsely

// Where the edge from a to b passes height y, for edges that reach from above it to below, one end included.
bool passes(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double y) { return (a.y() <= y) != (b.y() <= y); }

double place(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double y) {
  return a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

}  // namespace

cv::Mat outline_mask(std::span<const Polygon> outlines, const cv::Rect& window, int samples) {
  cv::Mat mask = cv::Mat::zeros(window.height * samples, window.width * samples, CV_8U);
  const auto sample_of = [samples](double px, int origin) { return (px - origin + 0.5) * samples - 0.5; };
  std::vector<std::vector<double>> passages(static_cast<std::size_t>(mask.rows));
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d& p = outline[i];
      const Eigen::Vector2d& q = outline[(i + 1) % outline.size()];
      const Eigen::Vector2d a(sample_of(p.x(), window.x), sample_of(p.y(), window.y));
      const Eigen::Vector2d b(sample_of(q.x(), window.x), sample_of(q.y(), window.y));
      const double low = std::max(0.0, std::floor(std::min(a.y(), b.y())));
      const double high = std::min(mask.rows - 1.0, std::ceil(std::max(a.y(), b.y())));
      for (int row = static_cast<int>(low); row <= high; ++row) {
        if (passes(a, b, row)) passages[static_cast<std::size_t>(row)].push_back(place(a, b, row));
      }
    }
  }
  for (int row = 0; row < mask.rows; ++row) {
    std::vector<double>& at = passages[static_cast<std::size_t>(row)];
    std::sort(at.begin(), at.end());
    std::uint8_t* values = mask.ptr<std::uint8_t>(row);
    for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
      const int from = static_cast<int>(std::clamp(std::ceil(at[i]), 0.0, static_cast<double>(mask.cols)));
      const int to = static_cast<int>(std::clamp(std::ceil(at[i + 1]), 0.0, static_cast<double>(mask.cols)));
      std::fill(values + from, values + to, std::uint8_t{255});
    }
  }
  return mask;
}

bool encloses(std::span<const Polygon> outlines, const Eigen::Vector2d& point) {
  bool inside = false;
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d& a = outline[i];
      const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
      if (passes(a, b, point.y()) && place(a, b, point.y()) <= point.x()) inside = !inside;
    }
  }
  return inside;
}

double dice(std::span<const Polygon> a, std::span<const Polygon> b) {
  Eigen::AlignedBox2d box;
  for (const auto& outlines : {a, b}) {
    for (const Polygon& outline : outlines) {
      for (const Eigen::Vector2d& point : outline) box.extend(point);
    }
  }
  if (box.isEmpty()) return 1.0;
  const Eigen::Vector2d corner = box.min().array().floor();
  const Eigen::Vector2d size = box.sizes().array() + 3.0;
  const double scale = std::min(1.0, kLongestSide / (kDiceSamples * size.maxCoeff()));
  const auto scaled = [&](std::span<const Polygon> outlines) {
    std::vector<Polygon> made(outlines.begin(), outlines.end());
    for (Polygon& outline : made) {
      for (Eigen::Vector2d& point : outline) point = scale * (point - corner);
    }
    return outline_mask(made, {0, 0, static_cast<int>(scale * size.x()) + 1, static_cast<int>(scale * size.y()) + 1},
                        kDiceSamples);
  };
  const cv::Mat in_a = scaled(a);
  const cv::Mat in_b = scaled(b);
  const int sum = cv::countNonZero(in_a) + cv::countNonZero(in_b);
  return sum == 0 ? 1.0 : 2.0 * cv::countNonZero(in_a & in_b) / sum;
}

}  // namespace fathom
