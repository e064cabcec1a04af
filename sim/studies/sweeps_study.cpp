#include "sim/studies/sweeps_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "core/error.h"
#include "measurement/partition_surface.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"
#include "sim/scan_plan.h"

namespace fathom {

namespace {

constexpr double kGoalPercent = 2.0;

struct PublishedObject {
  const char* object;
  std::array<int, 8> sections;
  std::array<double, 8> linear_percent;
  std::array<double, 8> surface_percent;
};

// Treece 2000, table 4.1; columns are sweep patterns (a) to (h).
constexpr std::array<PublishedObject, 4> kPublished = {{
    {"ellipsoid",
     {12, 13, 24, 16, 17, 21, 22, 17},
     {4.8, 5.9, 3.8, 5.8, 7.3, 6.9, 5.4, 7.2},
     {7.0, 7.7, 1.5, 9.3, 9.3, 1.8, 4.0, 9.0}},
    {"box",
     {12, 16, 15, 18, 19, 18, 19, 19},
     {1.5, 3.5, 7.7, 1.5, 5.6, 8.8, 4.4, 5.7},
     {1.6, 4.0, 2.0, 1.5, 4.4, 0.6, 0.5, 4.0}},
    {"concave",
     {12, 12, 18, 17, 17, 18, 16, 18},
     {5.7, 7.7, 4.1, 6.4, 7.9, 6.7, 7.4, 6.8},
     {12.0, 11.3, 2.5, 9.0, 10.7, 4.7, 6.2, 5.8}},
    {"branching",
     {16, 13, 16, 17, 22, 22, 18, 19},
     {1.0, 5.2, 5.2, 3.0, 6.5, 5.3, 5.3, 5.9},
     {7.8, 12.6, 4.7, 10.8, 10.5, 2.5, 7.0, 7.7}},
}};

std::size_t sweeps_in(const std::string& pattern) {
  for (const SweepPattern& several : sweep_table()) {
    if (pattern == several.name) return several.sweeps.size();
  }
  return 1;
}

/// Frames that show the object where their sweep is used.
int used_sections(const DividedScan& divided) {
  const SpacePartition& partition = divided.division.partition;
  std::set<int> frames;
  for (std::size_t region = 0; region < partition.region_count(); ++region) {
    const auto used = partition.sweep_in(region);
    if (!used) continue;
    const auto sections =
        section_outlines(divided.scan.outlines.front(), divided.locator, divided.division.sweeps[*used]);
    for (const CrossSection& section : clip_sections(sections, partition, region)) {
      frames.insert(section.frame);
    }
  }
  return static_cast<int>(frames.size());
}

/// The fewest sections with which these and all larger numbers keep an error within 2 %.
std::optional<SweepsMeasurement> sustained(const std::vector<SweepsMeasurement>& measurements,
                                           double SweepsMeasurement::*percent) {
  std::optional<SweepsMeasurement> fewest;
  for (auto m = measurements.rbegin(); m != measurements.rend(); ++m) {
    if (!(std::abs((*m).*percent) <= kGoalPercent)) break;
    fewest = *m;
  }
  return fewest;
}

double error_percent(const std::optional<double>& measured_ml, double true_ml) {
  if (!measured_ml) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * (*measured_ml / true_ml - 1.0);
}

SimulateOptions scan_options(const std::string& object, const std::string& pattern, int frames) {
  SimulateOptions options;
  options.object = object;
  options.pattern = pattern;
  options.frames = frames;
  return options;
}

}  // namespace

DividedScan divided_scan(const SimulateOptions& options) {
  SimulatedScan scan = simulate(options);
  FrameLocator locator(*scan.recording, scan.calibration);
  std::vector<Sweep> sweeps = find_sweeps(*scan.recording, locator);
  const RecordingHeader& header = scan.recording->header();
  std::vector<SweepShape> shapes;
  for (const Sweep& sweep : sweeps) shapes.push_back(sweep_shape(sweep, locator, header.width, header.height));
  SpacePartition partition = place_dividing_planes(std::move(shapes), nullptr);
  return {std::move(scan), std::move(locator), {std::move(sweeps), std::move(partition)}};
}

double cut_off_mm(const DividedScan& divided) {
  constexpr int kSamples = 100;  // along each line
  double largest_mm = 0.0;
  for (std::size_t i = 0; i < divided.division.sweeps.size(); ++i) {
    for (const Contour& contour : divided.scan.outlines.front().contours) {
      if (contour.closed || !contains(divided.division.sweeps[i], contour.frame)) continue;
      const auto reference_from_image = divided.locator.reference_from_image(contour.frame);
      if (!reference_from_image) continue;
      const auto place = [&](const Eigen::Vector2d& point) -> Eigen::Vector3d {
        return *reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0);
      };
      const Eigen::Vector3d start_mm = place(contour.points_px.back());
      const Eigen::Vector3d way_mm = place(contour.points_px.front()) - start_mm;
      int used = 0;
      for (int k = 0; k < kSamples; ++k) {
        if (divided.division.partition.sweep_at(start_mm + (k + 0.5) / kSamples * way_mm) == i) ++used;
      }
      largest_mm = std::max(largest_mm, way_mm.norm() * used / kSamples);
    }
  }
  return largest_mm;
}

SweepsMeasurement measure_sweeps(const std::string& object, const std::string& pattern, int frames) {
  const DividedScan divided = divided_scan(scan_options(object, pattern, frames));
  const PartitionedVolume volume = measure_partitions(divided.scan.outlines.front(), std::span(&divided.locator, 1),
                                                      divided.division.sweeps, divided.division.partition);
  const double true_ml = divided.scan.truth.volume_ml;
  SweepsMeasurement result;
  result.frames = frames;
  result.sections = used_sections(divided);
  result.linear_percent = error_percent(volume.total.linear_ml, true_ml);
  result.cubic_percent = error_percent(volume.total.cubic_ml, true_ml);
  result.quadric_percent = error_percent(volume.total.quadric_ml, true_ml);
  result.cut_off_mm = cut_off_mm(divided);
  for (const PartitionVolume& part : volume.partitions) result.missing_percent += 100.0 * part.missing_ml / true_ml;
  return result;
}

double surface_error_percent(const std::string& object, const std::string& pattern, int frames) {
  const DividedScan divided = divided_scan(scan_options(object, pattern, frames));
  try {
    const PartitionedSurface surface = partition_surface(divided.scan.outlines.front(), std::span(&divided.locator, 1),
                                                         divided.division, ContourSurfaceOptions{});
    return error_percent(surface.volume_ml, divided.scan.truth.volume_ml);
  } catch (const Error&) {  // too few sections in a sweep for a surface
    return std::numeric_limits<double>::quiet_NaN();
  }
}

std::vector<SweepsCell> published_sweeps_cells() {
  std::vector<SweepsCell> cells;
  for (const PublishedObject& printed : kPublished) {
    for (std::size_t i = 0; i < printed.sections.size(); ++i) {
      SweepsCell cell;
      cell.object = printed.object;
      cell.pattern = sweep_table()[i].name;
      cell.published_sections = printed.sections[i];
      cell.published_linear = printed.linear_percent[i];
      cell.published_surface = printed.surface_percent[i];
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

void summarise(SweepsCell& cell) {
  const auto off = [&](const SweepsMeasurement& m) { return std::abs(m.sections - cell.published_sections); };
  cell.sustained = sustained(cell.measurements, &SweepsMeasurement::cubic_percent);
  cell.sustained_quadric = sustained(cell.measurements, &SweepsMeasurement::quadric_percent);
  cell.at_published = cell.measurements.front();
  for (const SweepsMeasurement& m : cell.measurements) {
    if (off(m) < off(cell.at_published)) cell.at_published = m;
  }
}

SweepsCell measure_sweeps_cell(const SweepsCell& cell) {
  SweepsCell result = cell;
  const int sweeps = static_cast<int>(sweeps_in(cell.pattern));
  for (int frames = kFewestPerSweep * sweeps; frames <= kMostPerSweep * sweeps; ++frames) {
    result.measurements.push_back(measure_sweeps(cell.object, cell.pattern, frames));
  }
  summarise(result);
  result.surface_percent = surface_error_percent(cell.object, cell.pattern, result.at_published.frames);
  return result;
}

}  // namespace fathom
