#include "segmentation/region_growing.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "segmentation/edge_map.h"
#include "segmentation/outline_editing.h"
#include "segmentation/threshold.h"

namespace fathom {

namespace {

constexpr int kSeedRadius_px = 5;  // what is looked at around a seed
constexpr int kRounds = 5;         // of learning the region's values
constexpr double kWhole = 0.98;    // of the image: the region has no border
constexpr double kLeak = 1.3;      // a border half way to the surroundings may enlarge the region by so much
constexpr int kRingFrom_px = 4;    // the surroundings: between these distances of the region
constexpr int kRingTo_px = 10;
constexpr double kLeastSpread = 1.0;  // grey values: flat images have no spread to learn

struct Range {
  double low = 0.0;
  double high = 0.0;
};

cv::Mat disc(int radius) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}); }

// The parts of a mask that hold a seed, or come within `reach` pixels of one.
cv::Mat parts_with_seeds(const cv::Mat& mask, const std::vector<cv::Point>& seeds, int reach) {
  cv::Mat labels;
  cv::connectedComponents(mask, labels, 4, CV_32S);
  std::set<int> wanted;
  for (const cv::Point& seed : seeds) {
    const cv::Rect near =
        cv::Rect(seed.x - reach, seed.y - reach, 2 * reach + 1, 2 * reach + 1) & cv::Rect({}, mask.size());
    for (int y = near.y; y < near.br().y; ++y) {
      for (int x = near.x; x < near.br().x; ++x) {
        if (std::hypot(x - seed.x, y - seed.y) <= reach) wanted.insert(labels.at<int>(y, x));
      }
    }
  }
  cv::Mat chosen = cv::Mat::zeros(mask.size(), CV_8U);
  for (const int label : wanted) {
    if (label != 0) chosen |= labels == label;
  }
  return chosen;
}

cv::Mat region_in(const cv::Mat& smooth, const Range& range, const std::vector<cv::Point>& seeds, double neck_px) {
  cv::Mat mask;
  cv::inRange(smooth, cv::Scalar(range.low), cv::Scalar(range.high), mask);
  const int radius = static_cast<int>(std::lround(0.5 * neck_px));
  if (radius > 0) {
    cv::Mat narrow;
    cv::erode(mask, narrow, disc(radius), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
    const cv::Mat core = parts_with_seeds(narrow, seeds, radius);
    if (cv::countNonZero(core) > 0) {
      cv::Mat wide;
      cv::dilate(core, wide, disc(radius));
      return wide & mask;
    }
  }
  return parts_with_seeds(mask, seeds, 0);  // all of it is narrower than the neck
}

Range learnt_range(const cv::Mat& smooth, const cv::Mat& region, const RegionOptions& options) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(smooth, mean, deviation, region);
  const double spread = options.tolerance * std::max(deviation[0], kLeastSpread);
  return {options.low.value_or(mean[0] - spread), options.high.value_or(mean[0] + spread)};
}

// The range with its border half way between the region and what lies around it.
Range half_way(const cv::Mat& smooth, const cv::Mat& region, const Range& range, const RegionOptions& options) {
  cv::Mat near;
  cv::Mat far;
  cv::dilate(region, near, disc(kRingFrom_px));
  cv::dilate(region, far, disc(kRingTo_px));
  const cv::Mat ring = far & ~near;
  if (cv::countNonZero(ring) == 0) return range;
  const double inside = cv::mean(smooth, region)[0];
  const double middle = 0.5 * (inside + cv::mean(smooth, ring)[0]);
  Range moved = range;
  if (middle > inside && !options.high) moved.high = middle;
  if (middle < inside && !options.low) moved.low = middle;
  return moved;
}

std::vector<cv::Point> pixels_of(std::span<const Eigen::Vector2d> seeds, const cv::Size& size) {
  std::vector<cv::Point> pixels;
  for (const Eigen::Vector2d& seed : seeds) {
    if (!seed.allFinite() || seed.minCoeff() < -0.5 || seed.x() > size.width - 0.5 || seed.y() > size.height - 0.5) {
      throw Error("region: a seed lies outside of the image; place it inside");
    }
    pixels.emplace_back(std::clamp(static_cast<int>(std::lround(seed.x())), 0, size.width - 1),
                        std::clamp(static_cast<int>(std::lround(seed.y())), 0, size.height - 1));
  }
  if (pixels.empty()) throw Error("region: there is no seed; place one inside of the structure");
  return pixels;
}

cv::Mat grow(const cv::Mat& smooth, const std::vector<cv::Point>& seeds, const RegionOptions& options, Range& range) {
  cv::Mat region = cv::Mat::zeros(smooth.size(), CV_8U);
  for (const cv::Point& seed : seeds) cv::circle(region, seed, kSeedRadius_px, cv::Scalar(255), cv::FILLED);
  for (int round = 0; round < kRounds; ++round) {
    range = learnt_range(smooth, region, options);
    cv::Mat next = region_in(smooth, range, seeds, options.neck_px);
    if (cv::countNonZero(next) == 0) {
      throw Error(
          "region: the grey values at the seeds are out of the range; widen it, smooth the image more or move the "
          "seeds");
    }
    const bool same = cv::countNonZero(next != region) == 0;
    region = std::move(next);
    if (same || (options.low && options.high)) break;
  }
  const Range wider = half_way(smooth, region, range, options);
  cv::Mat next = region_in(smooth, wider, seeds, options.neck_px);
  const double size = cv::countNonZero(next);
  if (size > 0.0 && size <= kLeak * cv::countNonZero(region)) {
    range = wider;
    region = std::move(next);
  }
  return region;
}

}  // namespace

void RegionOptions::check() const {
  if (!(smoothing_px >= 0.0 && smoothing_px <= 50.0)) throw Error("region: the smoothing must be from 0 to 50 pixels");
  if (!(tolerance > 0.0 && tolerance <= 100.0)) throw Error("region: the tolerance must be above 0, to 100");
  if (!(neck_px >= 0.0 && neck_px <= 200.0)) throw Error("region: the neck must be from 0 to 200 pixels");
  if (!(fill_holes_px >= 0.0) || !std::isfinite(fill_holes_px)) throw Error("region: areas must not be negative");
  if ((low && !std::isfinite(*low)) || (high && !std::isfinite(*high)) || (low && high && !(*low <= *high))) {
    throw Error("region: the range is not finite or upside down; give finite values, the lower one first");
  }
}

std::vector<Polygon> grow_region(const cv::Mat& image, std::span<const Eigen::Vector2d> seeds_px,
                                 const RegionOptions& options) {
  options.check();
  cv::Mat smooth = grey_values(image);
  const std::vector<cv::Point> seeds = pixels_of(seeds_px, smooth.size());
  if (options.smoothing_px > 0.0) {
    cv::GaussianBlur(smooth, smooth, {}, options.smoothing_px, options.smoothing_px, cv::BORDER_REPLICATE);
  }
  Range range;
  const cv::Mat region = grow(smooth, seeds, options, range);
  if (cv::countNonZero(region) >= kWhole * static_cast<double>(region.total())) {
    throw Error("region: it is nearly all of the image, so that it has no border; narrow its range");
  }
  // How far inside of the range, and as far outside for what is in it but not of the region.
  cv::Mat depth = cv::min(cv::Mat(smooth - range.low), cv::Mat(range.high - smooth));
  const cv::Mat beside = -cv::abs(depth) - 1e-3;
  beside.copyTo(depth, region == 0);
  ThresholdOptions border;
  border.threshold = 0.0;
  CleanOptions clean;
  clean.fill_holes_px = options.fill_holes_px;
  return cleaned(threshold_outlines(depth, border), clean);
}

}  // namespace fathom
