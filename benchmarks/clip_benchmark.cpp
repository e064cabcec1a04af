// A bumpy ball of about 40 000 triangles, cut by the four planes of a tetrahedron that all cut into it.

#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/surface_fields.h"
#include "surface/isosurface.h"
#include "surface/mesh_clip.h"

namespace {

using namespace fathom;
using namespace fathom::benchmarks;

void ClipByFourPlanes(benchmark::State& state) {
  constexpr int kSize = 101;  // voxels: gives 40 000 triangles
  const Mesh mesh = isosurface(ball_volume(kSize, true), {});
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(0.5 * (kSize - 1));
  std::vector<Eigen::Hyperplane<double, 3>> planes;
  for (const Eigen::Vector3d& normal : {Eigen::Vector3d(1, 1.1, 1), Eigen::Vector3d(1, -1, -0.9),
                                        Eigen::Vector3d(-1, 1, -1.2), Eigen::Vector3d(-1, -1.1, 1)}) {
    planes.emplace_back(normal.normalized(), middle - 0.2 * kSize * normal.normalized());
  }
  const Caps caps = state.range(0) != 0 ? Caps::kClosed : Caps::kOpen;
  for (auto _ : state) benchmark::DoNotOptimize(clip_mesh(mesh, planes, caps));
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["left"] = static_cast<double>(clip_mesh(mesh, planes, caps).mesh.triangles.size());
}

BENCHMARK(ClipByFourPlanes)->ArgName("closed")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
