#include "registration/image_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "core/statistics.h"

namespace fathom {

namespace {

constexpr int kFewestFrames = 3;
constexpr double kMoves = 0.025;        // of the brightest value: noise of frame grabbers stays below
constexpr double kSmallestArea = 0.02;  // of the picture: less is a clock or a trace, no image
constexpr double kOnLine_px = 1.5;
constexpr double kParallel = 0.02;     // slope of sides that are those of a rectangle
constexpr double kSideRows = 0.25;     // of the rows must lie on a straight side
constexpr double kMostOutside = 0.02;  // of what moves may lie outside of the fan
constexpr double kLeastInside = 0.5;   // of the fan must move: shadows are dark
constexpr int kRays = 81;
constexpr std::uint64_t kSeed = 5;

// Where pixels move, 255; the largest connected part of that.
cv::Mat moving_part(const cv::Mat& least, const cv::Mat& largest) {
  cv::Mat range = largest - least;
  double brightest = 0.0;
  cv::minMaxLoc(largest.reshape(1), nullptr, &brightest);
  // Of a coloured picture a pixel moves with any of its channels.
  cv::Mat moves = range.reshape(1) > kMoves * brightest;
  if (range.channels() == 3) {
    cv::cvtColor(moves.reshape(3, range.rows), moves, cv::COLOR_RGB2GRAY);
    moves = moves > 0;
  }
  // Echoes touch within few pixels; letters and ticks around the image stand farther off.
  const cv::Mat square = cv::Mat::ones(3, 3, CV_8U);
  cv::morphologyEx(moves, moves, cv::MORPH_CLOSE, square);
  cv::morphologyEx(moves, moves, cv::MORPH_OPEN, square);
  cv::Mat labels, statistics, centres;
  const int parts = cv::connectedComponentsWithStats(moves, labels, statistics, centres);
  int largest_part = 0, area = 0;
  for (int part = 1; part < parts; ++part) {
    const int each = statistics.at<int>(part, cv::CC_STAT_AREA);
    if (each > area) std::tie(largest_part, area) = std::pair(part, each);
  }
  if (area < kSmallestArea * static_cast<double>(moves.total())) return {};
  return labels == largest_part;
}

// x = at + slope * y.
struct Side {
  double at = 0.0;
  double slope = 0.0;

  double off(const cv::Point2d& p) const { return p.x - at - slope * p.y; }
};

// Least squares over the points that lie on `side`.
Side refined(const Side& side, const std::vector<cv::Point2d>& points) {
  double n = 0, y = 0, x = 0, yy = 0, xy = 0;
  for (const cv::Point2d& p : points) {
    if (std::abs(side.off(p)) > kOnLine_px) continue;
    n += 1, y += p.y, x += p.x, yy += p.y * p.y, xy += p.x * p.y;
  }
  const double determinant = n * yy - y * y;
  if (determinant <= 0.0) return side;
  const double slope = (n * xy - x * y) / determinant;
  return {(x - slope * y) / n, slope};
}

// The straight side on which most rows' ends lie: the others lie on the arc below, or in shadow.
std::optional<Side> straight_side(const std::vector<cv::Point2d>& ends) {
  Random random(kSeed);
  const auto any = [&] { return ends[static_cast<std::size_t>(random.uniform(0, static_cast<double>(ends.size())))]; };
  Side best;
  std::ptrdiff_t most = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const cv::Point2d a = any(), b = any();
    if (std::abs(b.y - a.y) < 10.0) continue;
    Side side;
    side.slope = (b.x - a.x) / (b.y - a.y);
    side.at = a.x - side.slope * a.y;
    const auto on =
        std::count_if(ends.begin(), ends.end(), [&](const auto& p) { return std::abs(side.off(p)) <= kOnLine_px; });
    if (on > most) std::tie(best, most) = std::pair(side, on);
  }
  if (static_cast<double>(most) < kSideRows * static_cast<double>(ends.size())) return std::nullopt;
  return refined(best, ends);
}

// First and last radius along rays from the origin at which `part` is set, the usual ones.
void measure_radii(const cv::Mat& part, Fan& fan) {
  std::vector<double> first, last;
  const double farthest = std::hypot(part.cols * fan.pixel_aspect, part.rows) + fan.origin_px.norm();
  for (int ray = 1; ray < kRays - 1; ++ray) {
    const double angle = fan.min_angle_rad + (fan.max_angle_rad - fan.min_angle_rad) * ray / (kRays - 1);
    double begin = -1.0, end = -1.0;
    for (double radius = 0.0; radius < farthest; radius += 0.5) {
      const auto x = static_cast<int>(std::lround(fan.origin_px.x() + radius * std::sin(angle) / fan.pixel_aspect));
      const auto y = static_cast<int>(std::lround(fan.origin_px.y() + radius * std::cos(angle)));
      if (x < 0 || y < 0 || x >= part.cols || y >= part.rows || part.at<std::uint8_t>(y, x) == 0) continue;
      if (begin < 0.0) begin = radius;
      end = radius;
    }
    if (begin < 0.0) continue;
    first.push_back(begin);
    last.push_back(end);
  }
  if (first.empty()) return;
  fan.min_radius_px = std::max(0.0, median(first) - 0.5);
  // Shadows and the picture's border shorten rays, nothing lengthens them.
  std::sort(last.begin(), last.end());
  fan.max_radius_px = last[last.size() * 9 / 10] + 0.5;
}

std::optional<Fan> fit_fan(const cv::Mat& part, double pixel_aspect) {
  std::vector<cv::Point2d> left, right;
  for (int y = 0; y < part.rows; ++y) {
    const auto* row = part.ptr<std::uint8_t>(y);
    const auto* first = std::find(row, row + part.cols, 255);
    if (first == row + part.cols) continue;
    int last = part.cols - 1;
    while (row[last] == 0) --last;
    // The edges of pixels, as the fan's border runs between those inside and outside.
    left.emplace_back(static_cast<double>(first - row) - 0.5, y);
    right.emplace_back(last + 0.5, y);
  }
  if (left.size() < 20) return std::nullopt;
  const auto a = straight_side(left), b = straight_side(right);
  if (!a || !b || b->slope - a->slope < kParallel) return std::nullopt;
  Fan fan;
  fan.pixel_aspect = pixel_aspect;
  fan.origin_px.y() = (b->at - a->at) / (a->slope - b->slope);
  fan.origin_px.x() = a->at + a->slope * fan.origin_px.y();
  fan.min_angle_rad = std::atan(a->slope * pixel_aspect);
  fan.max_angle_rad = std::atan(b->slope * pixel_aspect);
  measure_radii(part, fan);
  if (!(fan.max_radius_px > fan.min_radius_px)) return std::nullopt;
  return fan;
}

bool fits(const Fan& fan, const cv::Mat& part) {
  double moving = 0, outside = 0, inside = 0, moving_inside = 0;
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      const bool moves = part.at<std::uint8_t>(y, x) != 0, within = fan.contains(x, y);
      moving += moves, inside += within, outside += moves && !within, moving_inside += moves && within;
    }
  }
  return outside <= kMostOutside * moving && moving_inside >= kLeastInside * inside;
}

}  // namespace

bool ImageShape::contains(double x_px, double y_px) const {
  if (fan) return fan->contains(x_px, y_px);
  return x_px >= box.x && y_px >= box.y && x_px <= box.x + box.width - 1 && y_px <= box.y + box.height - 1;
}

void ImageShapeFinder::add(const cv::Mat& frame) {
  if (frame.empty() || (frames_ > 0 && (frame.size() != least_.size() || frame.type() != least_.type()))) return;
  if (frames_++ == 0) {
    frame.copyTo(least_);
    frame.copyTo(largest_);
    return;
  }
  cv::min(least_, frame, least_);
  cv::max(largest_, frame, largest_);
}

std::optional<ImageShape> ImageShapeFinder::find(double pixel_aspect) const {
  if (frames_ < kFewestFrames) return std::nullopt;
  const cv::Mat part = moving_part(least_, largest_);
  if (part.empty()) return std::nullopt;
  ImageShape shape;
  shape.box = cv::boundingRect(part);
  const auto fan = fit_fan(part, pixel_aspect);
  if (fan && fits(*fan, part)) shape.fan = fan;
  return shape;
}

}  // namespace fathom
