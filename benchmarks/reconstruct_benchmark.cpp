// A real sweep as a voxel array at 0.5 mm: pixels inserted per second on one and two threads; holes of 25 Mvoxel.

#include <filesystem>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "registration/fill_holes.h"
#include "registration/reconstruct.h"
#include "tests/real_recordings.h"

namespace {

using namespace fathom;

void InsertSpine(benchmark::State& state) {
  const std::filesystem::path folder = real_recordings();
  if (!std::filesystem::exists(folder)) {
    state.SkipWithError("the recordings of data/plus are not on this machine");
    return;
  }
  const auto recording = open_recording(folder / "SpinePhantomFreehand.igs.mha");
  const FrameLocator locator(*recording,
                             read_calibration(folder / "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"));
  const auto frames = placed_frames(*recording, locator);
  const cv::Size size(recording->header().width, recording->header().height);
  std::vector<PlacedImage> images;
  for (const PlacedFrame& frame : frames) {
    images.push_back({recording->image(frame.frame).clone(), frame.reference_from_image});
  }
  ReconstructOptions options;
  options.spacing_mm = 0.5;
  options.insertion = state.range(0) == 0 ? Insertion::kNearest : Insertion::kLinear;
  cv::setNumThreads(static_cast<int>(state.range(1)));
  Reconstruction reconstruction(grid_around(frames, size, {}, 0.5), CV_8U, size, options);
  for (auto _ : state) reconstruction.insert(images);
  state.counters["pixels"] =
      benchmark::Counter(static_cast<double>(images.size()) * size.area() * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}
BENCHMARK(InsertSpine)->ArgNames({"linear", "threads"})->ArgsProduct({{0, 1}, {1, 2}})->UseRealTime();

// Planes three to six voxels apart and slightly turned, as frames leave them.
void FillHoles(benchmark::State& state) {
  constexpr int kSide = 292;  // 25 million voxels
  const int sizes[3] = {kSide, kSide, kSide};
  cv::Mat voxels = cv::Mat::zeros(3, sizes, CV_8U);
  cv::Mat filled = cv::Mat::zeros(3, sizes, CV_8U);
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if ((z + x / 20 + y / 50) % (3 + x / 80) != 0) continue;
        voxels.at<std::uint8_t>(z, y, x) = static_cast<std::uint8_t>(x ^ y ^ z);
        filled.at<std::uint8_t>(z, y, x) = 255;
      }
    }
  }
  cv::setNumThreads(static_cast<int>(state.range(0)));
  std::int64_t count = 0;
  for (auto _ : state) {
    state.PauseTiming();
    cv::Mat values = voxels.clone();
    cv::Mat marks = filled.clone();
    state.ResumeTiming();
    count = fill_holes(values, marks);
  }
  state.counters["holes"] = static_cast<double>(count);
}
BENCHMARK(FillHoles)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
