#include "sim/studies/calibration_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "core/random.h"
#include "core/statistics.h"
#include "sim/studies/seen_target.h"
#include "sim/studies/study_json.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrames = 250;  // ten seconds
constexpr int kStep = 4;      // every fourth image is looked at
constexpr double kNoise_px = 1.0;
constexpr double kMostLatency_s = 0.3;
constexpr double k95 = 1.96;

struct Target {
  const char* name;
  const char* object;
  bool estimate_phantom;
};
constexpr std::array<Target, 4> kTargets = {{{"wires", "wires", false},
                                             {"wires, place estimated", "wires", true},
                                             {"floor", "wall", false},
                                             {"point", "point", false}}};
constexpr std::array<double, 3> kNoises_mm = {0.0, 0.25, 0.5};
constexpr std::size_t kUsualNoise = 1;

struct CalibrationCase {
  const Target* target = nullptr;
  double noise_mm = 0.0;
  bool images = false;
};

CalibrationCase case_of(int index) {
  const auto i = static_cast<std::size_t>(index);
  return {&kTargets.at(i / kNoises_mm.size() % kTargets.size()), kNoises_mm.at(i % kNoises_mm.size()),
          i >= kTargets.size() * kNoises_mm.size()};
}

ScanFitOptions fitting_of(const CalibrationCase& of) {
  ScanFitOptions fitting;
  fitting.try_skew = false;
  fitting.estimate_phantom = of.target->estimate_phantom;
  return fitting;
}

Json json_of(const CalibrationTrial& trial) {
  return {{"point_mm", trial.point_mm},
          {"stated_mm", trial.stated_mm},
          {"latency_ms", 1e3 * trial.latency_s},
          {"normalised", std::vector<double>(trial.normalised.begin(), trial.normalised.end())}};
}

/// One scan with a latency of its own.
Json run_one(const CalibrationCase& of, std::uint64_t seed) {
  Random random(seed);
  TargetScanOptions scan = target_scan_of(of.target->object, kFrames, seed);
  scan.latency_s = random.uniform(-kMostLatency_s, kMostLatency_s);
  const SeenTarget seen =
      of.images ? SeenTarget::found_in_images(scan, kStep) : SeenTarget::drawn(scan, kNoise_px, seed + 1);
  try {
    return json_of(seen.calibrated(of.noise_mm, seed + 2, fitting_of(of)));
  } catch (const Error& error) {
    return {{"refused", error.what()}};
  }
}

/// Of all runs of a case.
struct Summary {
  int runs = 0;
  int refused = 0;
  double rms_mm = 0.0;
  double worst_mm = 0.0;
  double stated_mm = 0.0;   ///< median
  double latency_ms = 0.0;  ///< worst
  double within = 0.0;      ///< share of the normalised errors
  int parameters = 0;
};

Summary summary_of(const Json& result) {
  Summary summary;
  std::vector<double> stated;
  int within = 0;
  for (const Json& run : result.at("runs")) {
    ++summary.runs;
    if (run.contains("refused")) {
      ++summary.refused;
      continue;
    }
    const double mm = run.at("point_mm").get<double>();
    summary.rms_mm += mm * mm;
    summary.worst_mm = std::max(summary.worst_mm, mm);
    summary.latency_ms = std::max(summary.latency_ms, std::abs(run.at("latency_ms").get<double>()));
    stated.push_back(run.at("stated_mm").get<double>());
    for (const double normalised : run.at("normalised")) {
      ++summary.parameters;
      if (std::abs(normalised) <= k95) ++within;
    }
  }
  summary.rms_mm = std::sqrt(summary.rms_mm / std::max(1, summary.runs - summary.refused));
  summary.stated_mm = median(stated);
  summary.within = static_cast<double>(within) / std::max(1, summary.parameters);
  return summary;
}

StudyTable table_of(const std::vector<Json>& results, bool images) {
  StudyTable table;
  table.name = images ? "images" : "points";
  table.title = images ? "Through speckled images" : "From the true points, a pixel off on each axis";
  table.columns = {"target",
                   "tracker noise (mm)",
                   "scans",
                   "refused",
                   "error (mm)",
                   "worst (mm)",
                   "stated (mm)",
                   "errors within 1.96 sd (%)",
                   "latency, worst error (ms)"};
  table.remark =
      "Scans of 10 s, each with a hand, a tracker and a latency of its own. Error: rms over the whole image. Stated: "
      "the "
      "largest standard deviation of a pixel's place in the image that the calibration itself states, median over "
      "scans.";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CalibrationCase of = case_of(static_cast<int>(i));
    if (of.images != images) continue;
    const Summary summary = summary_of(results[i]);
    table.rows.push_back({of.target->name, format_rounded(of.noise_mm, 2), std::to_string(summary.runs),
                          std::to_string(summary.refused), format_rounded(summary.rms_mm, 3),
                          format_rounded(summary.worst_mm, 3), format_rounded(summary.stated_mm, 3),
                          format_rounded(100.0 * summary.within, 1), format_rounded(summary.latency_ms, 2)});
  }
  return table;
}

StudyPlot error_plot(const std::vector<Json>& results) {
  StudyPlot plot;
  plot.name = "error";
  plot.title = "Error of calibrations from points";
  plot.x_label = "tracker noise (mm)";
  plot.y_label = "rms error over the image (mm)";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CalibrationCase of = case_of(static_cast<int>(i));
    if (of.images) continue;
    if (i % kNoises_mm.size() == 0) plot.series.push_back({of.target->name, {}, {}, {}});
    plot.series.back().points.emplace_back(of.noise_mm, summary_of(results[i]).rms_mm);
  }
  return plot;
}

class CalibrationStudy final : public Study {
 public:
  std::string name() const override { return "calibration"; }
  std::string title() const override { return "how far off a probe's calibration is, and whether it says so"; }
  int cases(const StudyOptions&) const override { return static_cast<int>(2 * kTargets.size() * kNoises_mm.size()); }

  std::string case_name(const StudyOptions&, int index) const override {
    const CalibrationCase of = case_of(index);
    return std::string(of.target->name) + (of.images ? " in images, " : ", ") + format_rounded(of.noise_mm, 2) +
           " mm of noise";
  }

  Json run_case(const StudyOptions& options, int index) const override {
    const CalibrationCase of = case_of(index);
    return repeated(repetitions(options, of.images), case_seed(options, index),
                    [&](std::uint64_t seed) { return run_one(of, seed); });
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (std::size_t i = 0; i < results.size(); ++i) {
      const CalibrationCase of = case_of(static_cast<int>(i));
      const Summary summary = summary_of(results[i]);
      json.push_back({{"target", of.target->name},
                      {"images", of.images},
                      {"noise_mm", of.noise_mm},
                      {"scans", summary.runs},
                      {"refused", summary.refused},
                      {"error_mm", summary.rms_mm},
                      {"worst_mm", summary.worst_mm},
                      {"stated_mm", summary.stated_mm},
                      {"within_95_percent", 100.0 * summary.within},
                      {"latency_worst_ms", summary.latency_ms}});
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    StudyReport report;
    report.tables = {table_of(results, false), table_of(results, true)};
    report.plots = {error_plot(results)};
    add_goals(results, report);
    return report;
  }

 private:
  static void add_goals(const std::vector<Json>& results, StudyReport& report) {
    constexpr double kPoint_mm = 0.4;
    constexpr double kLatency_ms = 5.0;
    double worst_mm = 0.0;
    double latency_ms = 0.0;
    double within = 0.0;
    int parameters = 0;
    int refused = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const CalibrationCase of = case_of(static_cast<int>(i));
      const Summary summary = summary_of(results[i]);
      refused += summary.refused;
      if (of.noise_mm == kNoises_mm[kUsualNoise]) {
        latency_ms = std::max(latency_ms, summary.latency_ms);
        if (of.images) worst_mm = std::max(worst_mm, summary.rms_mm);
      }
      if (of.images) continue;
      within += summary.within * summary.parameters;
      parameters += summary.parameters;
    }
    report.goals.push_back({"place of a point through images, 0.25 mm of noise", "<= 0.4 mm rms for every target",
                            format_rounded(worst_mm, 3) + " mm", worst_mm <= kPoint_mm});
    report.goals.push_back({"latency found together with the calibration, 0.25 mm of noise", "<= 5 ms",
                            format_rounded(latency_ms, 2) + " ms worst", latency_ms <= kLatency_ms});
    const double percent = 100.0 * within / std::max(1, parameters);
    report.goals.push_back({"errors within 1.96 standard deviations stated, from points", "93 to 97 %",
                            format_rounded(percent, 1) + " % of " + std::to_string(parameters),
                            93.0 <= percent && percent <= 97.0});
    report.goals.push_back({"sound scans that are refused", "none", std::to_string(refused), refused == 0});
  }
};

}  // namespace

const Study& calibration_study() {
  static const CalibrationStudy study;
  return study;
}

}  // namespace fathom
