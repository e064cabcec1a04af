#include "sim/studies/planimetry_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "measurement/planimetry.h"

namespace fathom {

namespace {

constexpr double kGoalPercent = 1.0;
constexpr int kFirstOfRms = 17;  // single errors at 20 planes may cross zero by luck

PlanimetryAccuracy summarised(std::vector<double> errors) {
  PlanimetryAccuracy result;
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

std::string count_text(const std::optional<int>& planes) { return planes ? std::to_string(*planes) : "-"; }

std::string percent_text(double percent, int decimals) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.*f", decimals, percent);
  return text;
}

}  // namespace

std::vector<PlanimetryRow> published_planimetry_rows() {
  struct Printed {
    const char* object;
    const char* pattern;
    std::array<int, 3> planes;  // 0: more than 20
    std::array<double, 3> error_percent;
  };
  // Treece 2000, table 2.1, columns 1 to 3.
  static const std::array<Printed, 14> table = {{
      {"sphere", "linear", {11, 6, 6}, {-0.2, 0.1, 0.1}},
      {"sphere", "fan", {0, 9, 10}, {-1.4, -0.1, -0.1}},
      {"sphere", "free", {20, 9, 9}, {-0.9, -0.1, -0.1}},
      {"ellipsoid", "linear", {11, 6, 6}, {-0.3, 0.0, 0.0}},
      {"ellipsoid", "oblique", {11, 6, 6}, {-0.2, 0.1, 0.1}},
      {"ellipsoid", "free", {0, 9, 9}, {-1.3, 0.0, 0.1}},
      {"cone", "linear", {8, 5, 5}, {0.2, 0.0, 0.0}},
      {"cone", "fan", {0, 9, 9}, {-1.8, -1.3, -1.3}},
      {"cube", "free", {12, 8, 8}, {-0.5, 0.0, 0.0}},
      {"glove", "linear", {12, 6, 6}, {-0.3, 0.1, 0.1}},
      {"glove", "linear-y", {9, 6, 6}, {-0.2, 0.0, 0.0}},
      {"glove", "free", {0, 16, 15}, {-2.4, -0.6, -0.3}},
      {"hat", "linear", {10, 9, 9}, {-0.3, 0.0, 0.0}},
      {"hat", "free", {0, 14, 14}, {-1.9, 0.0, 0.0}},
  }};
  std::vector<PlanimetryRow> rows;
  for (const Printed& printed : table) {
    PlanimetryRow row;
    row.object = printed.object;
    row.pattern = printed.pattern;
    for (std::size_t method = 0; method < 3; ++method) {
      if (printed.planes[method] > 0) row.published[method].planes_below_1_percent = printed.planes[method];
      row.published[method].error_percent_at_20 = printed.error_percent[method];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

PlanimetryRow measure_planimetry_row(const PlanimetryRow& row) {
  std::array<std::vector<double>, 3> errors;
  for (int planes = kFewestPlanes; planes <= kMostPlanes; ++planes) {
    SimulateOptions options;
    options.object = row.object;
    options.pattern = row.pattern;
    options.frames = planes;
    const SimulatedScan scan = simulate(options);
    const FrameLocator locator(*scan.recording, scan.calibration);
    const auto sections = cross_sections(scan.outlines.front(), locator, nullptr);
    const PlanimetryVolumes volumes = measure_planimetry(sections).volumes;
    const std::array<std::optional<double>, 3> by_method = {volumes.linear_ml, volumes.cubic_ml, volumes.cubic_3d_ml};
    for (std::size_t method = 0; method < 3; ++method) {
      // No volume at all counts as none below 1 %.
      errors[method].push_back(by_method[method] ? 100.0 * (*by_method[method] / scan.truth.volume_ml - 1.0)
                                                 : std::numeric_limits<double>::quiet_NaN());
    }
  }
  PlanimetryRow result = row;
  for (std::size_t method = 0; method < 3; ++method) result.methods[method] = summarised(std::move(errors[method]));
  return result;
}

std::vector<PlanimetryRow> planimetry_table(const Progress& progress) {
  std::vector<PlanimetryRow> rows = published_planimetry_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    report(progress, static_cast<double>(i) / static_cast<double>(rows.size()));
    rows[i] = measure_planimetry_row(rows[i]);
  }
  report(progress, 1.0);
  return rows;
}

std::string planimetry_table_text(const std::vector<PlanimetryRow>& rows) {
  std::string text =
      "| object | pattern | planes for < 1 %, sustained (published): linear | 2D cubic | 3D cubic "
      "| first < 1 %: linear | 2D | 3D "
      "| error at 20 planes, % (published): linear | 2D cubic | 3D cubic "
      "| rms over 17-20 planes, %: linear | 2D | 3D |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const PlanimetryRow& row : rows) {
    text += "| " + row.object + " | " + row.pattern;
    for (std::size_t m = 0; m < 3; ++m) {
      text += " | " + count_text(row.methods[m].planes_below_1_percent) + " (" +
              count_text(row.published[m].planes_below_1_percent) + ")";
    }
    for (const PlanimetryAccuracy& method : row.methods) text += " | " + count_text(method.first_below_1_percent);
    for (std::size_t m = 0; m < 3; ++m) {
      text += " | " + percent_text(row.methods[m].error_percent_at_20, 2) + " (" +
              percent_text(row.published[m].error_percent_at_20, 1) + ")";
    }
    for (const PlanimetryAccuracy& method : row.methods) text += " | " + percent_text(method.rms_percent_17_to_20, 2);
    text += " |\n";
  }
  return text;
}

}  // namespace fathom
