#include "registration/geometry_watch.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/numbers.h"

namespace fathom {

namespace {

constexpr double kDepthTolerance = 0.005;
constexpr double kLit = 0.06;         // of the brightest: noise of dark parts stays below
constexpr int kMargin_px = 3;         // around the shape, where either may be
constexpr double kMostAround = 0.01;  // of the shape's area may light up outside of it: a clock, a cursor
constexpr int kWindowsOff = 2;
// A fan's least radius is the probe's own, in pixels, and known to some pixels.
constexpr double kRadiusOff = 0.04;
constexpr double kRadiusOff_px = 5.0;
// The face of a probe is lit also in air. A scanner keeps its picture in the middle, shadows come from one side.
constexpr int kFaceRows = 12;
constexpr int kFaceShift_px = 4;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Pictures of one grey value of 8 bits, for comparison.
cv::Mat grey_of(const cv::Mat& image) {
  cv::Mat grey = image;
  if (grey.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

double brightest_of(const cv::Mat& image) {
  double brightest = 0.0;
  cv::minMaxLoc(image, nullptr, &brightest);
  return brightest;
}

// First and last column that is lit in the uppermost rows of `box`; -1 where none is.
cv::Range lit_columns(const cv::Mat& picture, const cv::Rect& box, double lit) {
  cv::Mat columns;
  cv::reduce(picture(cv::Rect(box.x, box.y, box.width, std::min(box.height, kFaceRows))), columns, 0, cv::REDUCE_MAX);
  columns = columns > lit;
  cv::Range range(-1, -1);
  for (int x = 0; x < columns.cols; ++x) {
    if (columns.at<std::uint8_t>(0, x) == 0) continue;
    if (range.start < 0) range.start = x;
    range.end = x;
  }
  return range;
}

}  // namespace

const std::optional<std::string>& GeometryWatch::add(const LiveFrame& frame) {
  if (fault_) return fault_;
  const cv::Mat& image = frame.image;
  if (frames_++ == 0) {
    size_ = image.size();
    type_ = image.type();
    window_starts_s_.fill(frame.time_s);
  }
  const auto text = [](const cv::Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); };
  if (image.size() != size_) {
    fault_ = "the images changed from " + text(size_) + " to " + text(image.size()) + " pixels";
  } else if (image.type() != type_) {
    fault_ = "the images' pixels changed their type";
  } else {
    check_fields(frame);
  }
  if (fault_) since_s_ = frame.time_s;
  if (fault_ || image.empty()) return fault_;
  if (window_.frames() == 0) {
    std::rotate(window_starts_s_.begin(), window_starts_s_.begin() + 1, window_starts_s_.end());
    window_starts_s_.back() = frame.time_s;
  }
  window_.add(image);
  if (frames_ < options_.first_frames) return fault_;
  if (frames_ == options_.first_frames) {
    learn();
    window_ = {};
  } else if (window_.frames() >= options_.window_frames) {
    windows_off_ = shape_ && differs() ? windows_off_ + 1 : 0;
    window_ = {};
    if (windows_off_ >= kWindowsOff) {
      // The window before these may have ended with some such frames already.
      static_assert(kWindowsOff + 1 == std::tuple_size_v<decltype(window_starts_s_)>);
      since_s_ = window_starts_s_.front();
      fault_ = "the picture is no longer shown as before: the depth, zoom or probe seems to have been changed";
    }
  }
  return fault_;
}

void GeometryWatch::check_fields(const LiveFrame& frame) {
  for (const auto& [name, value] : frame.fields) {
    const auto depth = parse_real(value);
    if (!depth || lower(name).find("depth") == std::string::npos) continue;
    const auto [known, added] = depths_.emplace(name, *depth);
    if (!added && std::abs(*depth - known->second) > kDepthTolerance * std::abs(known->second)) {
      fault_ = "the scanner's depth changed (" + name + " from " + format_real(known->second) + " to " +
               format_real(*depth) + ")";
    }
  }
}

void GeometryWatch::learn() {
  shape_ = window_.find();
  if (!shape_) return;
  background_ = grey_of(window_.largest()).clone();
  inside_ = cv::Mat::zeros(size_, CV_8U);
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      if (shape_->contains(x, y)) inside_.at<std::uint8_t>(y, x) = 255;
    }
  }
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * kMargin_px + 1, 2 * kMargin_px + 1));
  cv::dilate(inside_, around_, disc);
  around_ = 255 - around_;
}

bool GeometryWatch::differs() {
  const cv::Mat largest = grey_of(window_.largest());
  if (lit_around(largest)) return true;
  return shape_->fan ? fan_moved(window_.find()) : face_drawn_in(largest);
}

bool GeometryWatch::lit_around(const cv::Mat& largest) const {
  cv::Mat change;
  cv::absdiff(largest, background_, change);
  const int pixels = cv::countNonZero((change > kLit * brightest_of(background_)) & around_);
  return pixels > kMostAround * cv::countNonZero(inside_);
}

// Shadows leave out scan lines, but the others still start on the same circle. Both windows must find the same new one:
// a poor fit is not found twice.
bool GeometryWatch::fan_moved(const std::optional<ImageShape>& now) {
  const std::optional<double> before = std::exchange(moved_radius_px_, std::nullopt);
  if (!now || !now->fan) return false;
  const double usual = shape_->fan->min_radius_px, radius = now->fan->min_radius_px;
  const double tolerance = std::max(kRadiusOff_px, kRadiusOff * usual);
  if (std::abs(radius - usual) <= tolerance) return false;
  moved_radius_px_ = radius;
  return !before || std::abs(radius - *before) <= 0.5 * tolerance;
}

bool GeometryWatch::face_drawn_in(const cv::Mat& largest) const {
  const double lit = kLit * brightest_of(background_);
  const cv::Range usual = lit_columns(background_, shape_->box, lit), now = lit_columns(largest, shape_->box, lit);
  if (usual.start < 0 || now.start < 0) return false;
  const int left = now.start - usual.start, right = usual.end - now.end;
  return std::min(left, right) >= kFaceShift_px &&
         std::abs(left - right) <= std::max(kFaceShift_px, (left + right) / 8);
}

std::function<std::optional<GeometryFault>(const LiveFrame&)> watching(std::shared_ptr<GeometryWatch> watch) {
  return [watch = std::move(watch)](const LiveFrame& frame) -> std::optional<GeometryFault> {
    if (!watch->add(frame)) return std::nullopt;
    return GeometryFault{*watch->fault(), watch->since_s()};
  };
}

}  // namespace fathom
