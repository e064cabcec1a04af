// A surface through contours and its parts: 20 sections, about 40 000 triangles; whole and after one edited contour.
// CPU is that of all threads: the time it takes on one core.

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "measurement/contour_lattice.h"
#include "measurement/contour_surface.h"
#include "measurement/section_gap.h"
#include "tests/measurement/sphere_scan.h"

namespace {

using namespace fathom;

constexpr int kSections = 20;
constexpr double kSpacingMm = 0.84;  // for 40 000 triangles
constexpr double kCellMm = 0.5 * kSpacingMm;

// A bent body of 70 by 60 by 95 mm, at a place along the sweep: an outline with a bay on one side, of 150 points.
Polygon bent_outline_mm(double z) {
  const double u = z / 47.5;
  const double size = std::sqrt(std::max(0.02, 1.0 - u * u));
  Polygon outline;
  for (int i = 0; i < 150; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 150;
    const double bay = 1.0 - 0.35 * std::exp(-8.0 * (1.0 - std::cos(angle - 1.0)));
    outline.emplace_back(30.0 + 12.0 * u * u + 35.0 * size * bay * std::cos(angle),
                         30.0 + 6.0 * u + 30.0 * size * bay * std::sin(angle));
  }
  return outline;
}

double place_mm(int section) { return -47.0 + 94.0 * section / (kSections - 1); }

PlacedSection placed(int section) {
  std::vector<Polygon> outlines = {bent_outline_mm(place_mm(section))};
  const SectionRaster raster = section_raster(outlines, kCellMm);
  return {{Eigen::Vector3d(0.0, 0.0, place_mm(section)), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()},
          std::make_shared<SectionShape>(std::move(outlines), raster)};
}

Structure bent_body(const FrameLocator& locator) {
  Structure structure;
  structure.name = "body";
  for (int frame = 0; frame < locator.frame_count(); ++frame) {
    Contour contour;
    contour.frame = frame;
    contour.points_px = bent_outline_mm(place_mm(frame));
    structure.contours.push_back(contour);
  }
  return structure;
}

FrameLocator sweep() { return scan_of(turning_sweep(evenly(place_mm(0), place_mm(kSections - 1), kSections)), 1.0); }

void MakeSectionShape(benchmark::State& state) {
  const std::vector<Polygon> outlines = {bent_outline_mm(0.0)};
  for (auto _ : state) {
    const SectionShape shape(outlines, section_raster(outlines, kCellMm));
    benchmark::DoNotOptimize(shape.inside_discs().data());
  }
  const SectionShape shape(outlines, section_raster(outlines, kCellMm));
  state.counters["cells"] = static_cast<double>(shape.raster().size());
  state.counters["discs"] = static_cast<double>(shape.inside_discs().size() + shape.outside_discs().size());
}

void SampleGap(benchmark::State& state, Guide guide, int section) {
  const PlacedSection first = placed(section);
  const PlacedSection second = placed(section + 1);
  const ContourLattice lattice = contour_lattice(Lattice::kBodyCentred, kSpacingMm, {-5.0, -5.0}, {70.0, 65.0}, 4.0);
  const int count = layers_between(place_mm(1) - place_mm(0), kSpacingMm);
  for (auto _ : state) benchmark::DoNotOptimize(gap_layers(lattice, SectionGap(first, second, guide), count));
  state.counters["samples"] = static_cast<double>(lattice.samples_per_layer() * (count - 1));
}

void MakeSurface(benchmark::State& state, Guide guide, GapOrder order) {
  const FrameLocator locator = sweep();
  const Structure structure = bent_body(locator);
  ContourSurfaceOptions options;
  options.guide = guide;
  options.order = order;
  options.spacing_mm = kSpacingMm;
  std::size_t triangles = 0;
  for (auto _ : state) {
    ContourSurface surface(locator, options);
    triangles = surface.update(structure).triangles.size();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void EditSurface(benchmark::State& state, Guide guide, GapOrder order) {
  const FrameLocator locator = sweep();
  Structure structure = bent_body(locator);
  ContourSurfaceOptions options;
  options.guide = guide;
  options.order = order;
  options.spacing_mm = kSpacingMm;
  ContourSurface surface(locator, options);
  surface.update(structure);
  double step = 0.5;
  for (auto _ : state) {
    structure.contours[kSections / 2].points_px[10].x() += step;
    step = -step;
    benchmark::DoNotOptimize(surface.update(structure).triangles.data());
  }
}

BENCHMARK(MakeSectionShape)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(SampleGap, discs_middle, Guide::kDiscs, kSections / 2)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(SampleGap, discs_end, Guide::kDiscs, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(SampleGap, shape_end, Guide::kShape, 0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(SampleGap, centroids_middle, Guide::kCentroids, kSections / 2)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(MakeSurface, discs, Guide::kDiscs, GapOrder::kLinear)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(MakeSurface, discs_curved, Guide::kDiscs, GapOrder::kCurved)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(MakeSurface, shape, Guide::kShape, GapOrder::kLinear)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(MakeSurface, centroids, Guide::kCentroids, GapOrder::kLinear)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(EditSurface, discs, Guide::kDiscs, GapOrder::kLinear)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(EditSurface, discs_curved, Guide::kDiscs, GapOrder::kCurved)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
