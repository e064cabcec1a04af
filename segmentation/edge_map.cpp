#include "segmentation/edge_map.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

constexpr int kScales = 3;
constexpr double kLeastScale = 0.3;
constexpr double kScaleOfSpeckle = 0.5;
constexpr double kMostOwnScale = 4.0;  // coarser edges are for the user to ask for
constexpr int kWidestGrain_px = 10;
constexpr double kGrainOfStrongest = 0.02;   // weaker grains are the tails of edges
constexpr double kGrainReach = 4.0;          // of their middle strength
constexpr double kNoGrain_px = 8.0;          // standard deviation: what stays after such smoothing is no grain
constexpr float kRayleighMedian = 1.17741F;  // median length of a vector whose components have a deviation of 1
// Where nothing but edges is in the image, their own gradients are taken for noise; they still count this much.
constexpr float kNoiseOfStrongest = 0.1F;

// Standard deviation of the noise of a gradient, of its components: from where the image changes at all, since what
// lies outside of a scanner's sector says nothing.
float noise_of(const cv::Mat& length) {
  double strongest = 0.0;
  cv::minMaxLoc(length, nullptr, &strongest);
  if (!(strongest > 0.0)) return 0.0F;
  const float floor = static_cast<float>(1e-3 * strongest);
  std::vector<float> values;
  for (int y = 0; y < length.rows; ++y) {
    const float* row = length.ptr<float>(y);
    // A third of the pixels of every row estimates a median as well as all.
    for (int x = y % 3; x < length.cols; x += 3) {
      if (row[x] > floor) values.push_back(row[x]);
    }
  }
  const auto most = kNoiseOfStrongest * static_cast<float>(strongest);
  if (values.empty()) return most;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::min(*middle / kRayleighMedian, most);
}

// Central differences: symmetric, so that a straight edge keeps its place.
void gradient_of(const cv::Mat& smooth, cv::Mat& across, cv::Mat& down) {
  const cv::Mat kernel = (cv::Mat_<float>(1, 3) << -0.5F, 0.0F, 0.5F);
  cv::filter2D(smooth, across, CV_32F, kernel, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
  cv::filter2D(smooth, down, CV_32F, kernel.t(), {-1, -1}, 0.0, cv::BORDER_REPLICATE);
}

// Not smaller than both of its neighbours along the gradient, to the nearest of eight directions.
cv::Mat ridge_of(const cv::Mat& gradient) {
  std::vector<cv::Mat> parts;
  cv::split(gradient, parts);
  cv::Mat length;
  cv::magnitude(parts[0], parts[1], length);
  cv::Mat ridge = cv::Mat::zeros(length.size(), CV_8U);
  constexpr float kTan = 0.41421356F;  // of 22.5 degrees
  for (int y = 1; y + 1 < length.rows; ++y) {
    const auto* g = gradient.ptr<cv::Vec2f>(y);
    const float* here = length.ptr<float>(y);
    for (int x = 1; x + 1 < length.cols; ++x) {
      const float ax = std::abs(g[x][0]);
      const float ay = std::abs(g[x][1]);
      const int dx = ax > kTan * ay ? (g[x][0] > 0.0F ? 1 : -1) : 0;
      const int dy = ay > kTan * ax ? (g[x][1] > 0.0F ? 1 : -1) : 0;
      if (here[x] > 0.0F && here[x] >= length.at<float>(y + dy, x + dx) && here[x] > length.at<float>(y - dy, x - dx)) {
        ridge.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  return ridge;
}

// Full width at half height of the autocorrelation along x (or y).
double correlation_width(const cv::Mat& grains, bool along_y) {
  const double power = grains.dot(grains);
  if (!(power > 0.0)) return 1.0;
  double before = 1.0;
  for (int lag = 1; lag <= kWidestGrain_px / 2; ++lag) {
    const int length = along_y ? grains.rows : grains.cols;
    if (lag >= length) break;
    const cv::Mat a = along_y ? grains.rowRange(0, length - lag) : grains.colRange(0, length - lag);
    const cv::Mat b = along_y ? grains.rowRange(lag, length) : grains.colRange(lag, length);
    const double now = a.dot(b) / power;
    if (now < 0.5) return std::max(1.0, 2.0 * (lag - 1 + (before - 0.5) / (before - now)));
    before = now;
  }
  return kWidestGrain_px;
}

}  // namespace

double speckle_size_px(const cv::Mat& grey) {
  cv::Mat coarse;
  cv::GaussianBlur(grey, coarse, {}, kNoGrain_px, kNoGrain_px, cv::BORDER_REPLICATE);
  cv::Mat grains = grey - coarse;
  // Edges are no grains: most of the image says how strong those are.
  std::vector<float> sizes;
  for (int y = 0; y < grains.rows; ++y) {
    const float* row = grains.ptr<float>(y);
    for (int x = y % 3; x < grains.cols; x += 3) {
      if (row[x] != 0.0F) sizes.push_back(std::abs(row[x]));
    }
  }
  if (sizes.empty()) return 1.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  double strongest = 0.0;
  cv::minMaxLoc(cv::abs(grains), nullptr, &strongest);
  if (*middle < kGrainOfStrongest * strongest) return 1.0;
  grains = cv::min(cv::max(grains, -kGrainReach * *middle), kGrainReach * *middle);
  return std::sqrt(correlation_width(grains, false) * correlation_width(grains, true));
}

void EdgeMapOptions::check() const {
  if (scale_px && !(*scale_px >= kLeastScale && *scale_px <= kMostScale_px)) {
    throw Error("scale of edges: must be from 0.3 to 50 pixels; about the size of the speckle is right");
  }
}

Eigen::Vector2d EdgeMap::at(const Eigen::Vector2d& point_px) const {
  const double x = std::clamp(point_px.x(), 0.0, gradient.cols - 1.0);
  const double y = std::clamp(point_px.y(), 0.0, gradient.rows - 1.0);
  const int left = std::min(static_cast<int>(x), std::max(gradient.cols - 2, 0));
  const int top = std::min(static_cast<int>(y), std::max(gradient.rows - 2, 0));
  const int right = std::min(left + 1, gradient.cols - 1);
  const auto fx = static_cast<float>(x - left);
  const auto fy = static_cast<float>(y - top);
  const auto* upper = gradient.ptr<cv::Vec2f>(top);
  const auto* lower = gradient.ptr<cv::Vec2f>(std::min(top + 1, gradient.rows - 1));
  const cv::Vec2f value = (1.0F - fy) * ((1.0F - fx) * upper[left] + fx * upper[right]) +
                          fy * ((1.0F - fx) * lower[left] + fx * lower[right]);
  return {value[0], value[1]};
}

cv::Mat grey_values(const cv::Mat& image) {
  if (image.empty() || image.dims != 2) throw Error("outlining: the image is empty; give a recording with images");
  if (image.channels() != 1 && image.channels() != 3) {
    throw Error("outlining: the image has " + std::to_string(image.channels()) + " channels; give one of 1 or 3");
  }
  cv::Mat values;
  image.convertTo(values, CV_32F);
  if (values.channels() == 3) cv::cvtColor(values, values, cv::COLOR_RGB2GRAY);
  if (!cv::checkRange(values, true, nullptr, -1e30, 1e30)) {
    throw Error("outlining: the image has values that are not finite; mend the recording");
  }
  return values;
}

EdgeMap edge_map(const cv::Mat& image, const EdgeMapOptions& options) {
  options.check();
  const cv::Mat values = grey_values(image);
  cv::Mat across = cv::Mat::zeros(values.size(), CV_32F);
  cv::Mat down = cv::Mat::zeros(values.size(), CV_32F);
  EdgeMap map;
  double sigma =
      options.scale_px ? *options.scale_px : std::clamp(kScaleOfSpeckle * speckle_size_px(values), 1.0, kMostOwnScale);
  map.scale_px = sigma;
  cv::Mat smooth = values;
  double so_far = 0.0;
  for (int i = 0; i < kScales; ++i, sigma *= 2.0) {
    // Smoothed on from the scale before: variances add.
    const double more = std::sqrt(sigma * sigma - so_far * so_far);
    cv::GaussianBlur(smooth, smooth, {}, more, more, cv::BORDER_REPLICATE);
    so_far = sigma;
    cv::Mat gx;
    cv::Mat gy;
    gradient_of(smooth, gx, gy);
    cv::Mat length;
    cv::magnitude(gx, gy, length);
    const float noise = noise_of(length);
    if (!(noise > 0.0F)) continue;
    map.flat = false;
    cv::scaleAdd(gx, 1.0 / (kScales * noise), across, across);
    cv::scaleAdd(gy, 1.0 / (kScales * noise), down, down);
  }
  cv::merge(std::vector{across, down}, map.gradient);
  map.ridge = ridge_of(map.gradient);
  return map;
}

EdgeMap coarser(const EdgeMap& map, int factor) {
  if (factor <= 1) return map;
  const cv::Size size((map.gradient.cols + factor - 1) / factor, (map.gradient.rows + factor - 1) / factor);
  cv::Mat padded;
  cv::copyMakeBorder(map.gradient, padded, 0, size.height * factor - map.gradient.rows, 0,
                     size.width * factor - map.gradient.cols, cv::BORDER_REPLICATE);
  EdgeMap made;
  made.flat = map.flat;
  cv::resize(padded, made.gradient, size, 0.0, 0.0, cv::INTER_AREA);
  made.ridge = ridge_of(made.gradient);
  return made;
}

}  // namespace fathom
