#include "sim/studies/latency_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "core/random.h"
#include "core/statistics.h"
#include "registration/temporal_motion.h"
#include "sim/studies/seen_target.h"
#include "sim/studies/study_json.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<double, 3> kNoises_mm = {0.0, 0.25, 0.5};
constexpr double kDepthNoise_px = 0.5;
constexpr double kMostLatency_s = 0.48;
constexpr int kDrawnFrames = 500;
constexpr int kImageFrames = 300;
constexpr double k95 = 1.96;
constexpr double kGoal_ms = 2.0;

struct LatencyCase {
  double noise_mm = 0.0;
  bool images = false;
};

LatencyCase case_of(int index) {
  const auto i = static_cast<std::size_t>(index);
  return {kNoises_mm.at(i % kNoises_mm.size()), i >= kNoises_mm.size()};
}

/// The floor's true depth in the middle column, and noise.
Signal true_depth(const SimulatedTargetScan& scan, Random& random) {
  Signal depth{"floor", {}};
  const RecordingHeader& header = scan.recording->header();
  std::map<int, double> left;
  for (const TruePoint& point : scan.points) {
    if (point.name == "left") left[point.frame] = point.position_px.y();
    if (point.name != "right" || !left.contains(point.frame)) continue;
    const double middle = 0.5 * (left.at(point.frame) + point.position_px.y());
    depth.values.push_back(
        {*header.frames[static_cast<std::size_t>(point.frame)].time_s, middle + kDepthNoise_px * random.normal()});
  }
  return depth;
}

Json run_one(const LatencyCase& of, std::uint64_t seed) {
  Random random(seed);
  TargetScanOptions options = target_scan_of("wall", of.images ? kImageFrames : kDrawnFrames, seed);
  options.pattern = "floor";
  options.latency_s = random.uniform(-kMostLatency_s, kMostLatency_s);
  options.noise_mm = of.noise_mm;
  options.noise_deg = kTurnOfNoise_deg_per_mm * of.noise_mm;
  const SimulatedTargetScan scan = simulate_target(options);
  const Recording& recording = *scan.recording;
  try {
    const Signal depth = of.images ? floor_signal(recording, detect_wall(recording)) : true_depth(scan, random);
    const TemporalCalibration fit = find_latency(depth, probe_poses(recording, find_pose_chain(recording, {})));
    return {{"latency_ms", 1e3 * options.latency_s},
            {"error_ms", 1e3 * (fit.latency_s - options.latency_s)},
            {"stated_ms", 1e3 * fit.stddev_s}};
  } catch (const Error& error) {
    return {{"latency_ms", 1e3 * options.latency_s}, {"refused", error.what()}};
  }
}

struct Summary {
  int runs = 0;
  int refused = 0;
  double worst_ms = 0.0;
  double rms_ms = 0.0;
  double stated_ms = 0.0;  ///< median
  int within = 0;
};

Summary summary_of(const Json& result) {
  Summary summary;
  std::vector<double> stated;
  for (const Json& run : result.at("runs")) {
    ++summary.runs;
    if (run.contains("refused")) {
      ++summary.refused;
      continue;
    }
    const double error_ms = run.at("error_ms").get<double>();
    stated.push_back(run.at("stated_ms").get<double>());
    summary.worst_ms = std::max(summary.worst_ms, std::abs(error_ms));
    summary.rms_ms += error_ms * error_ms;
    if (std::abs(error_ms) <= k95 * stated.back()) ++summary.within;
  }
  summary.rms_ms = std::sqrt(summary.rms_ms / std::max(1, summary.runs - summary.refused));
  summary.stated_ms = median(stated);
  return summary;
}

double within_percent(const Summary& summary) {
  return 100.0 * summary.within / std::max(1, summary.runs - summary.refused);
}

StudyTable table_of(const std::vector<Json>& results) {
  StudyTable table;
  table.name = "errors";
  table.title = "Latency found over a floor";
  table.columns = {"floor's depth", "tracker noise (mm)", "scans",       "refused",
                   "worst (ms)",    "rms (ms)",           "stated (ms)", "within 1.96 stated (%)"};
  table.remark =
      "Latencies within +-480 ms. The floor's depth is the true one, half a pixel off at random, in scans of 20 s, or "
      "found in speckled images, in scans of 12 s. Stated: the standard deviation that goes with the result, median.";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const LatencyCase of = case_of(static_cast<int>(i));
    const Summary summary = summary_of(results[i]);
    table.rows.push_back({of.images ? "in images" : "given", format_rounded(of.noise_mm, 2),
                          std::to_string(summary.runs), std::to_string(summary.refused),
                          format_rounded(summary.worst_ms, 2), format_rounded(summary.rms_ms, 2),
                          format_rounded(summary.stated_ms, 2), format_rounded(within_percent(summary), 1)});
  }
  return table;
}

StudyPlot error_plot(const std::vector<Json>& results) {
  StudyPlot plot;
  plot.name = "error";
  plot.title = "Error against the latency itself, the floor's depth given";
  plot.x_label = "latency (ms)";
  plot.y_label = "error (ms)";
  for (std::size_t i = 0; i < kNoises_mm.size(); ++i) {
    StudySeries series{format_rounded(kNoises_mm[i], 2) + " mm of noise", {}, {}, {}};
    for (const Json& run : results.at(i).at("runs")) {
      if (run.contains("refused")) continue;
      series.points.emplace_back(run.at("latency_ms").get<double>(), run.at("error_ms").get<double>());
    }
    std::sort(series.points.begin(), series.points.end());
    plot.series.push_back(std::move(series));
  }
  return plot;
}

class LatencyStudy final : public Study {
 public:
  std::string name() const override { return "latency"; }
  std::string title() const override { return "how far off the delay between tracker and images is found"; }
  int cases(const StudyOptions&) const override { return static_cast<int>(2 * kNoises_mm.size()); }

  std::string case_name(const StudyOptions&, int index) const override {
    const LatencyCase of = case_of(index);
    return std::string(of.images ? "floor in images, " : "floor, ") + format_rounded(of.noise_mm, 2) + " mm of noise";
  }

  Json run_case(const StudyOptions& options, int index) const override {
    const LatencyCase of = case_of(index);
    return repeated(repetitions(options, of.images), case_seed(options, index),
                    [&](std::uint64_t seed) { return run_one(of, seed); });
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (std::size_t i = 0; i < results.size(); ++i) {
      const LatencyCase of = case_of(static_cast<int>(i));
      const Summary summary = summary_of(results[i]);
      json.push_back({{"images", of.images},
                      {"noise_mm", of.noise_mm},
                      {"scans", summary.runs},
                      {"refused", summary.refused},
                      {"worst_ms", summary.worst_ms},
                      {"rms_ms", summary.rms_ms},
                      {"stated_ms", summary.stated_ms},
                      {"within_95_percent", within_percent(summary)}});
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    StudyReport report;
    report.tables = {table_of(results)};
    report.plots = {error_plot(results)};
    double worst_ms = 0.0;
    Summary noisy;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const LatencyCase of = case_of(static_cast<int>(i));
      const Summary summary = summary_of(results[i]);
      if (of.noise_mm <= kNoises_mm[1]) worst_ms = std::max(worst_ms, summary.worst_ms);
      if (of.images) continue;
      noisy.runs += summary.runs;
      noisy.refused += summary.refused;
      noisy.within += summary.within;
    }
    report.goals.push_back({"error of the latency, up to 0.25 mm of noise", "<= 2 ms",
                            format_rounded(worst_ms, 2) + " ms worst", worst_ms <= kGoal_ms});
    report.goals.push_back({"errors within 1.96 standard deviations stated", ">= 93 %",
                            format_rounded(within_percent(noisy), 1) + " % of " + std::to_string(noisy.runs),
                            within_percent(noisy) >= 93.0 && noisy.refused == 0});
    return report;
  }
};

}  // namespace

const Study& latency_study() {
  static const LatencyStudy study;
  return study;
}

}  // namespace fathom
