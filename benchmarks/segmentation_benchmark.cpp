// Outlines by threshold of one frame of 330 x 420 pixels, and by live-wire and refinement of one of 640 x 480.

#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "segmentation/live_wire.h"
#include "segmentation/refine.h"
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

// A dark disc in noise of 2 pixels' grain.
cv::Mat disc_in_noise() {
  Random random(1);
  cv::Mat image(480, 640, CV_32F);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<float>(y, x) = static_cast<float>(random.normal());
  }
  cv::GaussianBlur(image, image, {}, 1.5, 1.0);
  image = 120.0 + 100.0 * image;
  cv::circle(image, {320, 240}, 150, cv::Scalar(60.0), cv::FILLED);
  image.convertTo(image, CV_8U);
  return image;
}

// The first path after a click, to the farthest pixel there is: the whole image has to be searched.
void LiveWireFarthestPath(benchmark::State& state) {
  LiveWire wire(disc_in_noise());
  wire.add_seed({320.0, 90.0});
  for (auto _ : state) {
    state.PauseTiming();
    wire.undo();
    wire.add_seed({1.0, 1.0});
    state.ResumeTiming();
    benchmark::DoNotOptimize(wire.wire_to({638.0, 478.0}));
  }
}

// Paths to a pointer that goes around a structure, one after the other, a click at every eighth of the way.
void LiveWirePointerMoves(benchmark::State& state) {
  LiveWire wire(disc_in_noise());
  wire.add_seed({470.0, 240.0});
  int step = 0;
  for (auto _ : state) {
    ++step;
    const double angle = 0.01 * (step % 600);
    const Eigen::Vector2d pointer(320.0 + 150.0 * std::cos(angle), 240.0 + 150.0 * std::sin(angle));
    benchmark::DoNotOptimize(wire.wire_to(pointer));
    if (step % 75 != 0) continue;
    state.PauseTiming();
    if (step % 600 == 0) {
      while (wire.undo()) {
      }
      wire.add_seed({470.0, 240.0});
    } else {
      wire.add_seed(pointer);
    }
    state.ResumeTiming();
  }
}

void LiveWireNewImage(benchmark::State& state) {
  const cv::Mat image = disc_in_noise();
  for (auto _ : state) benchmark::DoNotOptimize(LiveWire(image).seeds().size());
}

void Refine(benchmark::State& state) {
  const EdgeMap map = edge_map(disc_in_noise());
  std::vector<Polygon> drawn(1);
  for (int i = 0; i < 60; ++i) {
    drawn[0].emplace_back(320.0 + 155.0 * std::cos(i * 0.10472), 240.0 + 155.0 * std::sin(i * 0.10472));
  }
  const EdgePreference boundary = learn_boundary(map, drawn, {});
  for (auto _ : state) benchmark::DoNotOptimize(refine_outlines(map, drawn, boundary));
}

BENCHMARK(LiveWireFarthestPath)->Unit(benchmark::kMillisecond);
BENCHMARK(LiveWirePointerMoves)->Unit(benchmark::kMillisecond);
BENCHMARK(LiveWireNewImage)->Unit(benchmark::kMillisecond);
BENCHMARK(Refine)->Unit(benchmark::kMillisecond);
BENCHMARK(ThresholdBinary)->Unit(benchmark::kMicrosecond);
BENCHMARK(ThresholdNoise)->Unit(benchmark::kMicrosecond);

}  // namespace
