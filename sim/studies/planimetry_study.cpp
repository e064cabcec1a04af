#include "sim/studies/planimetry_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "measurement/contour_surface.h"
#include "measurement/planimetry.h"
#include "sim/studies/surface_study.h"

namespace fathom {

namespace {

constexpr double kGoalPercent = 1.0;
constexpr int kFirstOfRms = 17;  // single errors at 20 planes may cross zero by luck

/// What the table prints of planes, 0 for more than 20: columns 1 to 6.
using PrintedPlanes = std::array<int, 6>;

// Where columns 1 to 3 and 4 to 6 stand in kVolumeMethods.
constexpr std::array<std::size_t, 6> kPrintedMethods = {0, 1, 2, 4, 5, 6};

std::optional<PublishedAccuracy> printed(int planes, double error_percent) {
  PublishedAccuracy accuracy;
  if (planes > 0) accuracy.planes_below_1_percent = planes;
  accuracy.error_percent_at_20 = error_percent;
  return accuracy;
}

// By shapes, centroids, discs, and by discs to second order.
void measure_surfaces(const SimulatedScan& scan, const FrameLocator& locator, ScanVolumes& volumes) {
  constexpr std::array<std::pair<Guide, GapOrder>, 4> kinds = {{{Guide::kShape, GapOrder::kLinear},
                                                                {Guide::kCentroids, GapOrder::kLinear},
                                                                {Guide::kDiscs, GapOrder::kLinear},
                                                                {Guide::kDiscs, GapOrder::kCurved}}};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    ContourSurfaceOptions options;
    options.guide = kinds[i].first;
    options.order = kinds[i].second;
    options.spacing_mm = kSurfaceStudySpacing_mm;
    ContourSurface surface(locator, options);
    surface.update(scan.outlines.front());
    volumes.volume_ml[kPlanimetryMethods + i] = surface.volume_ml();
  }
}

}  // namespace

std::vector<PlanimetryRow> published_planimetry_rows() {
  struct Printed {
    const char* object;
    const char* pattern;
    PrintedPlanes planes;
    std::array<double, 3> error_percent;  // of columns 1 to 3; published_surface_rows has the others
  };
  // Treece 2000, table 2.1.
  static const std::array<Printed, 14> table = {{
      {"sphere", "linear", {11, 6, 6, 20, 20, 20}, {-0.2, 0.1, 0.1}},
      {"sphere", "fan", {0, 9, 10, 19, 19, 19}, {-1.4, -0.1, -0.1}},
      {"sphere", "free", {20, 9, 9, 15, 16, 16}, {-0.9, -0.1, -0.1}},
      {"ellipsoid", "linear", {11, 6, 6, 15, 15, 15}, {-0.3, 0.0, 0.0}},
      {"ellipsoid", "oblique", {11, 6, 6, 17, 17, 17}, {-0.2, 0.1, 0.1}},
      {"ellipsoid", "free", {0, 9, 9, 0, 0, 0}, {-1.3, 0.0, 0.1}},
      {"cone", "linear", {8, 5, 5, 0, 0, 0}, {0.2, 0.0, 0.0}},
      {"cone", "fan", {0, 9, 9, 17, 17, 17}, {-1.8, -1.3, -1.3}},
      {"cube", "free", {12, 8, 8, 14, 14, 12}, {-0.5, 0.0, 0.0}},
      {"glove", "linear", {12, 6, 6, 15, 15, 15}, {-0.3, 0.1, 0.1}},
      {"glove", "linear-y", {9, 6, 6, 15, 0, 15}, {-0.2, 0.0, 0.0}},
      {"glove", "free", {0, 16, 15, 0, 0, 0}, {-2.4, -0.6, -0.3}},
      {"hat", "linear", {10, 9, 9, 0, 0, 0}, {-0.3, 0.0, 0.0}},
      {"hat", "free", {0, 14, 14, 0, 0, 18}, {-1.9, 0.0, 0.0}},
  }};
  const std::vector<SurfaceVolumeRow> surfaces = published_surface_rows();
  std::vector<PlanimetryRow> rows;
  for (std::size_t i = 0; i < table.size(); ++i) {
    PlanimetryRow row;
    row.object = table[i].object;
    row.pattern = table[i].pattern;
    for (std::size_t m = 0; m < 3; ++m) {
      row.published[kPrintedMethods[m]] = printed(table[i].planes[m], table[i].error_percent[m]);
      row.published[kPrintedMethods[m + 3]] = printed(table[i].planes[m + 3], surfaces[i].published_percent[m]);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

bool is_rough(const PlanimetryRow& row) {
  return row.object == "cube" || (row.object == "cone" && row.pattern == "fan") ||
         (row.pattern == "free" && (row.object == "glove" || row.object == "hat"));
}

ScanVolumes measure_scan(const SimulateOptions& options, bool surfaces) {
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  const PlanimetryVolumes planimetry =
      measure_planimetry(cross_sections(scan.outlines.front(), locator, nullptr)).volumes;
  ScanVolumes volumes;
  volumes.true_ml = scan.truth.volume_ml;
  volumes.volume_ml = {planimetry.linear_ml, planimetry.cubic_ml, planimetry.cubic_3d_ml, planimetry.quadric_ml};
  if (surfaces) measure_surfaces(scan, locator, volumes);
  return volumes;
}

MethodAccuracy accuracy_of(std::vector<double> errors) {
  MethodAccuracy result;
  const auto error_at = [&](int planes) { return errors[static_cast<std::size_t>(planes - kFewestPlanes)]; };
  const auto good = [&](int planes) { return std::abs(error_at(planes)) < kGoalPercent; };
  for (int planes = kMostPlanes; planes >= kFewestPlanes && good(planes); --planes) {
    result.planes_below_1_percent = planes;
  }
  for (int planes = kFewestPlanes; planes <= kMostPlanes && !result.first_below_1_percent; ++planes) {
    if (good(planes)) result.first_below_1_percent = planes;
  }
  double sum = 0.0;
  double squares = 0.0;
  for (int planes = kFirstOfRms; planes <= kMostPlanes; ++planes) {
    sum += error_at(planes);
    squares += error_at(planes) * error_at(planes);
  }
  result.rms_percent_17_to_20 = std::copysign(std::sqrt(squares / (kMostPlanes - kFirstOfRms + 1)), sum);
  result.error_percent_at_20 = error_at(kMostPlanes);
  result.error_percent = std::move(errors);
  return result;
}

std::vector<MethodAccuracy> measure_planimetry_row(const PlanimetryRow& row) {
  std::array<std::vector<double>, kPlanimetryMethods> errors;
  for (int planes = kFewestPlanes; planes <= kMostPlanes; ++planes) {
    SimulateOptions options;
    options.object = row.object;
    options.pattern = row.pattern;
    options.frames = planes;
    const ScanVolumes volumes = measure_scan(options, false);
    for (std::size_t method = 0; method < kPlanimetryMethods; ++method) {
      const auto& volume_ml = volumes.volume_ml[method];
      errors[method].push_back(volume_ml ? 100.0 * (*volume_ml / volumes.true_ml - 1.0)
                                         : std::numeric_limits<double>::quiet_NaN());
    }
  }
  std::vector<MethodAccuracy> methods;
  for (auto& of_method : errors) methods.push_back(accuracy_of(std::move(of_method)));
  return methods;
}

}  // namespace fathom
