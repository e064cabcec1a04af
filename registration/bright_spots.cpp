#include "registration/bright_spots.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

// Echoes of wires are some 1/150 of the image high whatever its size, as the depth is set to what is looked at.
constexpr double kUnit = 1.0 / 300.0;  // of the smaller side
constexpr double kSurroundings = 8.0;  // half width of the window around a spot, in units
constexpr double kMadToDeviation = 1.4826;
constexpr int kSampleStep = 3;  // the texture's spread is taken from every third pixel each way
constexpr double kCutDrop =
    0.5;  // an edge that falls from this share of the peak to black within a pixel was cut, not blurred

cv::Mat mean_over(const cv::Mat& grey, int half_width, int half_height) {
  cv::Mat mean;
  cv::blur(grey, mean, cv::Size(2 * half_width + 1, 2 * half_height + 1), cv::Point(-1, -1), cv::BORDER_REPLICATE);
  return mean;
}

/// Spread of the values where there is texture: black pixels around the scanned area say nothing about it.
double texture_deviation(const cv::Mat& response, const cv::Mat& grey) {
  std::vector<float> values;
  for (int y = 0; y < response.rows; y += kSampleStep) {
    const float* in = response.ptr<float>(y);
    const float* level = grey.ptr<float>(y);
    for (int x = 0; x < response.cols; x += kSampleStep) {
      if (level[x] > 0.0F) values.push_back(std::abs(in[x]));
    }
  }
  // In a nearly black image what is not black are the spots themselves.
  constexpr double kTextured = 0.1;
  const double sampled = static_cast<double>(response.total()) / (kSampleStep * kSampleStep);
  if (static_cast<double>(values.size()) < kTextured * sampled) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return kMadToDeviation * static_cast<double>(*middle);
}

/// Grows a spot from its peak. `visited` marks pixels by the number of the spot that looked at them.
class SpotGrower {
 public:
  SpotGrower(const cv::Mat& smooth, const cv::Mat& raw, const BrightSpotOptions& options)
      : grey_(smooth),
        raw_(raw),
        visited_(smooth.size(), CV_32SC1, cv::Scalar(0)),
        options_(options),
        max_extent_(std::max(8, static_cast<int>(options.max_size * std::min(raw.rows, raw.cols)))) {}

  /// False where what is bright here is too large for a spot.
  bool grow(cv::Point peak, double background, BrightSpot& spot) {
    ++number_;
    const double height = static_cast<double>(grey_.at<float>(peak)) - background;
    if (height <= 0.0) return false;
    const double level = background + options_.height_level * height;
    pending_ = {peak};
    visited_.at<int>(peak) = number_;
    cv::Rect box(peak, cv::Size(1, 1));
    double weight = 0.0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int left_cuts = 0;
    int right_cuts = 0;
    bool at_border = false;
    while (!pending_.empty()) {
      const cv::Point at = pending_.back();
      pending_.pop_back();
      const double value = static_cast<double>(grey_.at<float>(at));
      const double w = value - level;
      weight += w;
      sum += w * Eigen::Vector2d(at.x, at.y);
      box |= cv::Rect(at, cv::Size(1, 1));
      if (box.width > max_extent_ || box.height > max_extent_) return false;
      for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        const cv::Point to = at + step;
        if (!inside(to)) {
          at_border = true;
          continue;
        }
        if (step.x != 0 && raw_.at<float>(to) <= 0.0F && static_cast<double>(raw_.at<float>(at)) > kCutDrop * height) {
          (step.x < 0 ? left_cuts : right_cuts)++;
        }
        if (visited_.at<int>(to) == number_ || static_cast<double>(grey_.at<float>(to)) <= level) continue;
        visited_.at<int>(to) = number_;
        pending_.push_back(to);
      }
    }
    if (weight <= 0.0) return false;
    spot.centre_px = sum / weight;
    spot.width_px = box.width;
    spot.height_px = box.height;
    spot.cut_off = at_border || left_cuts > 1 || right_cuts > 1;
    return true;
  }

 private:
  bool inside(cv::Point at) const { return at.x >= 0 && at.y >= 0 && at.x < grey_.cols && at.y < grey_.rows; }

  const cv::Mat& grey_;
  const cv::Mat& raw_;
  cv::Mat visited_;
  std::vector<cv::Point> pending_;
  const BrightSpotOptions& options_;
  int max_extent_;
  int number_ = 0;
};

}  // namespace

double full_scale(const cv::Mat& image) {
  switch (image.depth()) {
    case CV_8U:
      return 255.0;
    case CV_8S:
      return 127.0;
    case CV_16U:
      return 65535.0;
    case CV_16S:
      return 32767.0;
    default: {
      double largest = 0.0;
      cv::minMaxLoc(image.reshape(1), nullptr, &largest);
      return largest;
    }
  }
}

void BrightSpotOptions::check() const {
  if (max_spots < 1 || max_spots > 1000) throw Error("bright spots: the number of spots must be from 1 to 1000");
  if (!(min_contrast >= 0.0 && min_contrast < 1.0)) throw Error("bright spots: the contrast must be from 0 to 1");
  if (!(min_prominence >= 0.0 && min_prominence < 1000.0)) {
    throw Error("bright spots: the prominence must be from 0 to 1000 standard deviations");
  }
  if (!(max_size > 0.0 && max_size <= 1.0)) throw Error("bright spots: the largest size must be above 0, up to 1");
  if (!(height_level > 0.0 && height_level < 1.0)) throw Error("bright spots: the level must be between 0 and 1");
}

cv::Mat grey_image(const cv::Mat& image) {
  cv::Mat one;
  if (image.channels() == 3) {
    cv::cvtColor(image, one, cv::COLOR_RGB2GRAY);
  } else {
    one = image;
  }
  cv::Mat grey;
  one.convertTo(grey, CV_32F);
  cv::patchNaNs(grey, 0.0);
  return grey;
}

std::vector<BrightSpot> find_bright_spots(const cv::Mat& image, const BrightSpotOptions& options) {
  options.check();
  std::vector<BrightSpot> spots;
  if (image.empty() || std::min(image.rows, image.cols) < 8) return spots;
  const cv::Mat grey = grey_image(image);
  const int unit = std::max(1, static_cast<int>(std::lround(kUnit * std::min(grey.rows, grey.cols))));
  const int reach = static_cast<int>(std::lround(kSurroundings * unit));

  const cv::Mat inner = mean_over(grey, 2 * unit, unit);
  const cv::Mat outer = mean_over(grey, reach, reach);
  const cv::Mat response = inner - outer;
  cv::Mat largest;
  cv::dilate(response, largest, cv::Mat::ones(4 * unit + 1, 8 * unit + 1, CV_8UC1));
  const double least =
      std::max(options.min_contrast * full_scale(image), options.min_prominence * texture_deviation(response, grey));

  std::vector<std::pair<double, cv::Point>> peaks;
  for (int y = 0; y < response.rows; ++y) {
    const float* value = response.ptr<float>(y);
    const float* top = largest.ptr<float>(y);
    for (int x = 0; x < response.cols; ++x) {
      if (value[x] >= top[x] && static_cast<double>(value[x]) > least) {
        peaks.emplace_back(static_cast<double>(value[x]), cv::Point(x, y));
      }
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });

  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, cv::Size(0, 0), 0.5 * unit);
  SpotGrower grower(smooth, grey, options);
  for (const auto& [contrast, at] : peaks) {
    if (static_cast<int>(spots.size()) == options.max_spots) break;
    // The brightest pixel of the window whose mean was largest.
    const cv::Rect window =
        cv::Rect(at.x - 2 * unit, at.y - unit, 4 * unit + 1, 2 * unit + 1) & cv::Rect(cv::Point(0, 0), grey.size());
    cv::Point peak;
    cv::minMaxLoc(smooth(window), nullptr, nullptr, nullptr, &peak);
    BrightSpot spot;
    spot.contrast = contrast;
    // The mean around a spot includes the spot; what it adds there is small beside the level.
    if (!grower.grow(peak + window.tl(), static_cast<double>(outer.at<float>(at)), spot)) continue;
    const bool twin = std::any_of(spots.begin(), spots.end(), [&](const BrightSpot& other) {
      return (other.centre_px - spot.centre_px).norm() < 2.0 * unit;
    });
    if (!twin) spots.push_back(spot);
  }
  return spots;
}

}  // namespace fathom
