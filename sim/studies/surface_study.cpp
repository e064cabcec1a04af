#include "sim/studies/surface_study.h"

#include <chrono>
#include <cstdio>
#include <limits>

#include "measurement/contour_surface.h"
#include "sim/simulate.h"
#include "surface/mesh_check.h"
#include "surface/mesh_quality.h"

namespace fathom {

std::vector<SurfaceVolumeRow> published_surface_rows() {
  struct Printed {
    const char* object;
    const char* pattern;
    std::array<double, 3> error_percent;
  };
  // Treece 2000, table 2.1, columns 4 to 6.
  static const std::array<Printed, 14> table = {{{"sphere", "linear", {-0.8, -0.8, -0.8}},
                                                 {"sphere", "fan", {-0.9, -1.4, -1.1}},
                                                 {"sphere", "free", {0.0, -0.1, -0.1}},
                                                 {"ellipsoid", "linear", {-0.5, -0.5, -0.5}},
                                                 {"ellipsoid", "oblique", {-0.6, -0.6, -0.6}},
                                                 {"ellipsoid", "free", {-1.1, -1.6, -1.4}},
                                                 {"cone", "linear", {-1.8, -1.8, -1.8}},
                                                 {"cone", "fan", {-1.8, -1.6, -1.7}},
                                                 {"cube", "free", {-0.5, -0.5, -0.3}},
                                                 {"glove", "linear", {-1.2, -1.0, -0.9}},
                                                 {"glove", "linear-y", {-0.8, -1.9, -0.9}},
                                                 {"glove", "free", {-1.5, -1.5, -1.5}},
                                                 {"hat", "linear", {-2.2, -2.2, -1.8}},
                                                 {"hat", "free", {-1.4, -1.9, 0.1}}}};
  std::vector<SurfaceVolumeRow> rows;
  for (const Printed& printed : table) {
    SurfaceVolumeRow row;
    row.object = printed.object;
    row.pattern = printed.pattern;
    row.published_percent = printed.error_percent;
    rows.push_back(row);
  }
  return rows;
}

SurfaceVolumeRow measure_surface_row(const SurfaceVolumeRow& row) {
  SimulateOptions simulation;
  simulation.object = row.object;
  simulation.pattern = row.pattern;
  simulation.frames = kSurfaceStudyPlanes;
  const SimulatedScan scan = simulate(simulation);
  const FrameLocator locator(*scan.recording, scan.calibration);
  SurfaceVolumeRow result = row;
  constexpr std::array<Guide, 4> guides = {Guide::kShape, Guide::kCentroids, Guide::kDiscs, Guide::kDiscs};
  constexpr std::size_t kCurved = 3;
  for (std::size_t i = 0; i < guides.size(); ++i) {
    ContourSurfaceOptions options;
    options.guide = guides[i];
    options.order = i == kCurved ? GapOrder::kCurved : GapOrder::kLinear;
    options.spacing_mm = kSurfaceStudySpacing_mm;
    ContourSurface surface(locator, options);
    const auto start = std::chrono::steady_clock::now();
    const Mesh& mesh = surface.update(scan.outlines.front());
    result.seconds[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const MeshTopology topology = mesh_topology(mesh);
    result.closed[i] = topology.closed() && topology.manifold() && topology.oriented();
    const auto volume_ml = surface.volume_ml();
    result.error_percent[i] =
        volume_ml ? 100.0 * (*volume_ml / scan.truth.volume_ml - 1.0) : std::numeric_limits<double>::quiet_NaN();
    if (guides[i] != Guide::kDiscs || i == kCurved) continue;
    const MeshQuality quality = mesh_quality(mesh);
    result.radius_ratio_p95 = quality.radius_ratio_p95;
    result.above_2 = quality.above_2;
  }
  return result;
}

std::string surface_table_text(const std::vector<SurfaceVolumeRow>& rows) {
  std::string text =
      "| object | pattern | error at 20 planes, % (published): shape-based | centroid-guided | disc-guided "
      "| disc-guided, curved | radius ratio: 95th percentile | above 2 (%) | disc-guided (s) | curved (s) |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const SurfaceVolumeRow& row : rows) {
    char line[256];
    std::snprintf(line, sizeof line,
                  "| %s | %s | %+.2f (%+.1f) | %+.2f (%+.1f) | %+.2f (%+.1f) | %+.2f | %.2f | %.2f | %.2f | %.2f |\n",
                  row.object.c_str(), row.pattern.c_str(), row.error_percent[0], row.published_percent[0],
                  row.error_percent[1], row.published_percent[1], row.error_percent[2], row.published_percent[2],
                  row.error_percent[3], row.radius_ratio_p95, 100.0 * row.above_2, row.seconds[2], row.seconds[3]);
    text += line;
  }
  return text;
}

}  // namespace fathom
