#include <benchmark/benchmark.h>

#include "sim/phantom.h"
#include "sim/scan_path.h"
#include "sim/section.h"
#include "sim/simulate.h"

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

}  // namespace
