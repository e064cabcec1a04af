#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "registration/partition.h"

// Dragging a dividing plane: every move assigns sweeps to all parts of space anew.
namespace {

using fathom::DividingPlane;
using fathom::SpacePartition;

fathom::SweepShape sweep_at(double x_mm, int frames) {
  fathom::SweepShape shape;
  for (int i = 0; i < frames; ++i) shape.centres_mm.emplace_back(x_mm + 0.01 * i, 30.0, 0.5 * i);
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d(-20, 0, 0), Eigen::Vector3d(20, 0, 0),
                                        Eigen::Vector3d(20, 60, 0), Eigen::Vector3d(-20, 60, 0)}) {
    shape.first_corners_mm.emplace_back(corner + Eigen::Vector3d(x_mm, 0, 0));
    shape.last_corners_mm.emplace_back(corner + Eigen::Vector3d(x_mm, 0, 0.5 * frames));
  }
  return shape;
}

void move_a_plane(benchmark::State& state) {
  const int frames = static_cast<int>(state.range(0)) / 3;
  const auto planes = static_cast<int>(state.range(1));
  std::vector<DividingPlane> all;
  for (int i = 0; i < planes; ++i) {
    all.emplace_back(Eigen::Vector3d(1.0, 0.3 * (i % 3), 0.2 * (i % 5)).normalized(),
                     Eigen::Vector3d(-15.0 + 30.0 * i / planes, 30.0, 0.25 * frames));
  }
  SpacePartition partition({sweep_at(-25, frames), sweep_at(0, frames), sweep_at(25, frames)}, all);
  double shift_mm = 0.0;
  for (auto _ : state) {
    shift_mm = shift_mm > 2.0 ? 0.0 : shift_mm + 0.1;
    DividingPlane plane = all.front();
    plane.offset() += shift_mm;
    partition.move(0, plane);
    benchmark::DoNotOptimize(partition.cells().data());
  }
  state.counters["cells"] = static_cast<double>(partition.cells().size());
}

BENCHMARK(move_a_plane)->ArgNames({"frames", "planes"})->Args({600, 4})->Args({600, 8})->Unit(benchmark::kMillisecond);

}  // namespace
