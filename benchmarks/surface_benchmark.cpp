// From fields of 128^3 and 256^3 to meshes with normals: from samples that lie on the mesher's lattice, and from
// volumes, which are sampled first. On one and two threads.

#include <cmath>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "benchmarks/surface_fields.h"
#include "surface/isosurface.h"
#include "surface/layer_mesher.h"

namespace {

using namespace fathom;
using namespace fathom::benchmarks;

enum Method { kAverage, kCurvature, kTetrahedra, kCubes };

MesherOptions options_of(benchmark::State& state) {
  MesherOptions options;
  switch (state.range(0)) {
    case kCurvature:
      options.placement = VertexPlacement::kCurvature;
      break;
    case kTetrahedra:
      options.mesher = Mesher::kTetrahedra;
      break;
    case kCubes:
      options.mesher = Mesher::kCubes;
      break;
    default:
      break;
  }
  return options;
}

void MeshSamples(benchmark::State& state) {
  const MesherOptions options = options_of(state);
  const int size = static_cast<int>(state.range(1));
  const bool centred = options.lattice() == Lattice::kBodyCentred;
  const double step = centred ? std::numbers::sqrt2 : 1.0;
  std::vector<SampledLayer> layers(static_cast<std::size_t>(size));
  std::vector<const SampledLayer*> stack;
  for (int k = 0; k < size; ++k) {
    SampledLayer& layer = layers[static_cast<std::size_t>(k)];
    layer.columns = static_cast<int>(size / step);
    layer.rows = size;
    layer.origin = Eigen::Vector3d(0.0, 0.0, k);
    layer.column_step = Eigen::Vector3d(step, 0.0, 0.0);
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < layer.columns; ++i) {
        const double x = step * (i + (centred ? 0.5 * ((j + k) % 2) : 0.0));
        layer.values.push_back(static_cast<float>(ball_field(size, state.range(2) != 0, Eigen::Vector3d(x, j, k))));
      }
    }
    stack.push_back(&layer);
  }
  cv::setNumThreads(static_cast<int>(state.range(3)));
  for (auto _ : state) benchmark::DoNotOptimize(join(mesh_layers(stack, 0, size, options)));
}

void MeshVolume(benchmark::State& state) {
  IsosurfaceOptions options;
  options.mesher = options_of(state);
  const Volume volume = ball_volume(static_cast<int>(state.range(1)), state.range(2) != 0);
  cv::setNumThreads(static_cast<int>(state.range(3)));
  for (auto _ : state) benchmark::DoNotOptimize(isosurface(volume, options));
}

BENCHMARK(MeshSamples)
    ->ArgNames({"method", "size", "bumpy", "threads"})
    ->ArgsProduct({{kAverage, kCurvature, kTetrahedra, kCubes}, {128, 256}, {0, 1}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(MeshVolume)
    ->ArgNames({"method", "size", "bumpy", "threads"})
    ->ArgsProduct({{kAverage, kCurvature, kTetrahedra, kCubes}, {128, 256}, {0, 1}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
