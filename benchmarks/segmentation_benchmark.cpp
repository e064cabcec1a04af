// Outlines by threshold of one frame of 330 x 420 pixels.

#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "core/random.h"
#include "segmentation/threshold.h"

namespace {

using namespace fathom;

constexpr int kWidth = 330;
constexpr int kHeight = 420;

void outline(benchmark::State& state, const cv::Mat& image) {
  for (auto _ : state) benchmark::DoNotOptimize(threshold_outlines(image, {}));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));  // frames a second
}

// A binary ring, as the simulator's B-scans.
void ThresholdBinary(benchmark::State& state) {
  cv::Mat image = cv::Mat::zeros(kHeight, kWidth, CV_8U);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double radius = std::hypot(x - 165.0, y - 210.0);
      if (radius < 150.0 && radius > 60.0) image.at<std::uint8_t>(y, x) = 255;
    }
  }
  outline(state, image);
}

// The worst there is: noise from pixel to pixel.
void ThresholdNoise(benchmark::State& state) {
  Random random(1);
  cv::Mat image(kHeight, kWidth, CV_8U);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.uniform(0.0, 256.0));
    }
  }
  outline(state, image);
}

BENCHMARK(ThresholdBinary)->Unit(benchmark::kMicrosecond);
BENCHMARK(ThresholdNoise)->Unit(benchmark::kMicrosecond);

}  // namespace
