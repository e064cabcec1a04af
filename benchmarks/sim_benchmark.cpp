#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "sim/phantom.h"
#include "sim/scan_path.h"
#include "sim/section.h"
#include "sim/simulate.h"
#include "sim/speckle.h"

// B-scans of 330x420 pixels and their true outlines; items are frames.

namespace {

constexpr int kFrames = 100;

fathom::SimulateOptions options_of(const char* object) {
  fathom::SimulateOptions options;
  options.object = object;
  options.pattern = "free";
  options.frames = kFrames;
  return options;
}

void RenderFrame(benchmark::State& state, const char* object) {
  const fathom::SimulatedScan scan = fathom::simulate(options_of(object));
  int frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(scan.recording->image(frame).data);
    frame = (frame + 1) % kFrames;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(RenderFrame, sphere, "sphere");
BENCHMARK_CAPTURE(RenderFrame, glove, "glove");
BENCHMARK_CAPTURE(RenderFrame, hat, "hat");
BENCHMARK_CAPTURE(RenderFrame, kidney, "kidney");

// A scene's B-scan of 640 x 480 pixels, on one thread.
void SceneFrame(benchmark::State& state, const char* object) {
  cv::setNumThreads(1);
  fathom::SimulateOptions options = options_of(object);
  options.speckle.emplace();
  const fathom::SimulatedScan scan = fathom::simulate(options);
  int frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(scan.recording->image(frame).data);
    frame = (frame + 1) % kFrames;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(SceneFrame, bladder, "bladder");
BENCHMARK_CAPTURE(SceneFrame, bladder_prostate, "bladder-prostate");
BENCHMARK_CAPTURE(SceneFrame, ducts, "ducts");
BENCHMARK_CAPTURE(SceneFrame, foetus, "foetus");

void OutlineFrame(benchmark::State& state, const char* object) {
  const fathom::Phantom phantom = fathom::make_phantom(object);
  const fathom::ScanPath path = fathom::make_scan_path(phantom, "free");
  int frame = 0;
  for (auto _ : state) {
    const auto image = path.phantom_from_image(path.at((frame + 0.5) / kFrames), phantom.pixel_mm);
    benchmark::DoNotOptimize(fathom::section_outlines(*phantom.solid, image));
    frame = (frame + 1) % kFrames;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(OutlineFrame, sphere, "sphere");
BENCHMARK_CAPTURE(OutlineFrame, hat, "hat");
BENCHMARK_CAPTURE(OutlineFrame, kidney, "kidney");

// A B-scan of 640 x 480 pixels of 0.1 mm with an object in it, on one thread.
void SpeckledFrame(benchmark::State& state) {
  cv::setNumThreads(1);
  const fathom::SpeckleOptions options;
  const fathom::SpeckleField field(options);
  cv::Mat inside(480, 640, CV_8UC1, cv::Scalar(0));
  inside(cv::Rect(200, 150, 240, 180)).setTo(255);
  Eigen::Affine3d plane(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  plane.linear() *= 0.1;
  for (auto _ : state) {
    plane.translation() += Eigen::Vector3d(0.1, 0.2, 0.3);
    benchmark::DoNotOptimize(fathom::speckled_image(field, options, inside, plane));
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(SpeckledFrame)->Unit(benchmark::kMillisecond);

}  // namespace
