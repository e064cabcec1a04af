#include "segmentation/threshold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "segmentation/outline_loops.h"

namespace fathom {

namespace {

// Pixels. Outlines keep this far from pixel centres, so that they never touch each other, and a pixel at the threshold
// lies truly inside.
constexpr double kMargin = 1e-6;

constexpr double kMostSmoothing_px = 50.0;

constexpr std::uint8_t kInside = 1;
constexpr std::uint8_t kTraced = 2;  // an outline through the left side of this pixel has been followed

struct Pixel {
  int x = 0;
  int y = 0;
};

// East, south, west, north; y runs down.
constexpr std::array<Pixel, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr int kWest = 2;

Pixel step(Pixel from, int direction) {
  const Pixel& by = kSteps[static_cast<std::size_t>(direction)];
  return {from.x + by.x, from.y + by.y};
}

// Follows outlines from one pair of neighbouring pixels, one inside and one outside, to the next: marching squares,
// visiting only the squares that an outline passes through.
template <typename Value>
class OutlineTracer {
 public:
  OutlineTracer(const cv::Mat& image, const ThresholdOptions& options)
      : image_(image),
        options_(options),
        stride_(image.cols + 2),
        marks_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(image.rows + 2), std::uint8_t{0}) {
    for (int y = 0; y < image.rows; ++y) {
      const Value* values = image.ptr<Value>(y);
      std::uint8_t* marks = &mark({0, y});
      for (int x = 0; x < image.cols; ++x) marks[x] = is_inside(static_cast<double>(values[x])) ? kInside : 0;
    }
  }

  std::vector<Polygon> trace() {
    std::vector<std::pair<double, Polygon>> found;
    for (int y = 0; y < image_.rows; ++y) {
      const std::uint8_t* marks = &mark({0, y});
      for (int x = 0; x < image_.cols; ++x) {
        // Every outline, of a part or of a hole, has an inside pixel with an outside one on its left.
        if (marks[x] != kInside || (marks[x - 1] & kInside) != 0) continue;
        Polygon outline = follow({x, y});
        const double size = std::abs(signed_area(outline));
        if (size >= options_.min_area_px) found.emplace_back(size, std::move(outline));
      }
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Polygon> outlines;
    outlines.reserve(found.size());
    for (auto& [size, outline] : found) outlines.push_back(std::move(outline));
    return outlines;
  }

 private:
  bool is_inside(double value) const {
    return (value >= options_.threshold && value <= options_.upper) != options_.below;
  }

  // Of a pixel of the image or of the frame of outside pixels, one wide, that is laid around it.
  std::uint8_t& mark(Pixel at) {
    return marks_[static_cast<std::size_t>(at.y + 1) * static_cast<std::size_t>(stride_) +
                  static_cast<std::size_t>(at.x + 1)];
  }

  bool inside(Pixel at) { return (mark(at) & kInside) != 0; }

  bool in_image(Pixel at) const { return at.x >= 0 && at.y >= 0 && at.x < image_.cols && at.y < image_.rows; }

  // How far the value is on the inner side of the threshold.
  double depth(Pixel at) const {
    const double value = static_cast<double>(image_.ptr<Value>(at.y)[at.x]);
    const double within = std::min(value - options_.threshold, options_.upper - value);
    return options_.below ? -within : within;
  }

  // Where the outline passes between two neighbours.
  Eigen::Vector2d passage(Pixel in, Pixel out) const {
    double share = 0.5;
    if (in_image(out)) {
      const double linear = depth(in) / (depth(in) - depth(out));
      if (std::isfinite(linear)) share = std::clamp(linear, kMargin, 1.0 - kMargin);
    }
    return {in.x + share * (out.x - in.x), in.y + share * (out.y - in.y)};
  }

  // Whether two inside pixels across a square are joined: by the value at the saddle point of the bilinear surface
  // through the four. It does not matter from where the square is entered, so no outlines cross in it. A square with
  // an equal claim both ways joins.
  bool joined(Pixel in, Pixel in_across, Pixel out, Pixel out_across) const {
    return depth(in) * depth(in_across) >= depth(out) * depth(out_across);
  }

  // The outline that passes on the left of `first`, with the inside on its right.
  Polygon follow(Pixel first) {
    Polygon outline;
    Pixel in = first;
    int outward = kWest;
    do {
      if (outward == kWest) mark(in) |= kTraced;
      const Pixel out = step(in, outward);
      append(outline, passage(in, out));
      const int along = (outward + 1) % 4;
      const Pixel in_ahead = step(in, along);
      const Pixel out_ahead = step(out, along);
      const bool a = inside(in_ahead);
      const bool b = inside(out_ahead);
      if (a && !b) {
        in = in_ahead;
      } else if (b && (a || joined(in, out_ahead, out, in_ahead))) {
        in = out_ahead;
        outward = (outward + 3) % 4;
      } else {
        outward = along;
      }
    } while (outward != kWest || in.x != first.x || in.y != first.y);
    return outline;
  }

  // Leaves out points in the middle of a line along a row or a column, which say nothing.
  static void append(Polygon& outline, const Eigen::Vector2d& point) {
    const std::size_t n = outline.size();
    const auto in_line = [&](int axis) {
      return outline[n - 1][axis] == point[axis] && outline[n - 2][axis] == point[axis];
    };
    if (n >= 2 && (in_line(0) || in_line(1))) {
      outline.back() = point;
    } else {
      outline.push_back(point);
    }
  }

  const cv::Mat& image_;
  const ThresholdOptions& options_;
  int stride_;
  std::vector<std::uint8_t> marks_;
};

template <typename Value>
std::vector<Polygon> outlines_of(const cv::Mat& image, const ThresholdOptions& options) {
  return OutlineTracer<Value>(image, options).trace();
}

}  // namespace

void ThresholdOptions::check() const {
  if (!std::isfinite(threshold)) throw Error("threshold: must be a finite number; give a grey value");
  if (!(upper >= threshold)) throw Error("threshold: the upper one is below the other; give the lower one first");
  if (!(smoothing_px >= 0.0 && smoothing_px <= kMostSmoothing_px)) {
    throw Error("threshold: the smoothing must be from 0 to 50 pixels");
  }
  if (!std::isfinite(min_area_px) || min_area_px < 0.0) {
    throw Error("smallest area: must not be negative; give it in square pixels, 0 to keep all");
  }
}

std::vector<Polygon> threshold_outlines(const cv::Mat& image, const ThresholdOptions& options) {
  options.check();
  if (image.channels() != 1) {
    throw Error("threshold: the image has " + std::to_string(image.channels()) +
                " channels; a threshold needs grey values, so give an image of one channel");
  }
  if (options.smoothing_px > 0.0 && !image.empty()) {
    cv::Mat smooth;
    image.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, smooth, {}, options.smoothing_px, options.smoothing_px, cv::BORDER_REPLICATE);
    return outlines_of<float>(smooth, options);
  }
  switch (image.depth()) {
    case CV_8U:
      return outlines_of<std::uint8_t>(image, options);
    case CV_8S:
      return outlines_of<std::int8_t>(image, options);
    case CV_16U:
      return outlines_of<std::uint16_t>(image, options);
    case CV_16S:
      return outlines_of<std::int16_t>(image, options);
    case CV_32S:
      return outlines_of<std::int32_t>(image, options);
    case CV_32F:
      return outlines_of<float>(image, options);
    case CV_64F:
      return outlines_of<double>(image, options);
    default:
      break;
  }
  cv::Mat values;
  image.convertTo(values, CV_32F);  // half floats
  return outlines_of<float>(values, options);
}

}  // namespace fathom
