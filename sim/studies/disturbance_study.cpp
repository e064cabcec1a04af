#include "sim/studies/disturbance_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "core/numbers.h"
#include "core/statistics.h"
#include "sim/studies/planimetry_study.h"
#include "sim/studies/scan_picture.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kObject = "glove";
constexpr const char* kPattern = "linear-y";
constexpr int kPlanes = 10;
constexpr double kSize_mm = 20.0;  // of the object

struct Scale {
  double location_mm;
  double orientation_deg;
};

constexpr std::array<Scale, 5> kScales = {{{0.2, 1.0}, {0.5, 2.5}, {1.0, 5.0}, {2.0, 10.0}, {4.0, 20.0}}};
constexpr std::size_t kPublishedScale = 2;   // the text speaks of errors of 5 % of the object's size
constexpr std::size_t kPublishedMethod = 1;  // 2D cubic planimetry
constexpr std::size_t kQuadric = 3;

/// How a study's planes are displaced.
struct Variant {
  const char* name;  ///< in results; of files too
  const char* label;
  bool steady_ends;
};

/// What sets the two studies apart.
struct Disturbance {
  const char* study;
  const char* title;
  double SimulateOptions::*location_mm;
  double SimulateOptions::*orientation_deg;
  double published_percent;  ///< "about": the error that errors of up to 5 % of the object's size cause
  const char* remark;
  std::vector<Variant> variants;
};

struct Spread {
  int volumes = 0;  ///< samples that have one
  double smallest = 0.0;
  double lower = 0.0;
  double median = 0.0;
  double upper = 0.0;
  double largest = 0.0;
};

Spread spread_of(const std::vector<double>& errors) {
  if (errors.empty()) return {};
  const auto [smallest, largest] = std::minmax_element(errors.begin(), errors.end());
  return {static_cast<int>(errors.size()), *smallest, quantile(errors, 0.25), quantile(errors, 0.5),
          quantile(errors, 0.75),          *largest};
}

std::string percent_text(double percent) { return format_signed(percent, 2); }

std::string range_text(double low, double high) { return percent_text(low) + " to " + percent_text(high) + " %"; }

class DisturbanceStudy final : public Study {
 public:
  explicit DisturbanceStudy(const Disturbance& disturbance) : disturbance_(disturbance) {}

  std::string name() const override { return disturbance_.study; }
  std::string title() const override { return disturbance_.title; }

  int cases(const StudyOptions& options) const override {
    return 1 + static_cast<int>(disturbance_.variants.size() * kScales.size()) * options.samples;
  }

  std::string case_name(const StudyOptions& options, int index) const override {
    if (index == 0) return "undisturbed";
    return std::string(variant_of(options, index).label) + ", scale " + std::to_string(scale_of(options, index) + 1) +
           ", sample " + std::to_string((index - 1) % options.samples + 1);
  }

  Json run_case(const StudyOptions& options, int index) const override {
    const ScanVolumes volumes = measure_scan(scan_of(options, index), false);
    Json errors;
    for (std::size_t m = 0; m < kPlanimetryMethods; ++m) {
      const auto& volume_ml = volumes.volume_ml[m];
      errors[kVolumeMethods[m].name] = volume_ml ? Json(100.0 * (*volume_ml / volumes.true_ml - 1.0)) : Json(nullptr);
    }
    return {{"error_percent", errors}};
  }

  Json rows(const StudyOptions& options, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (std::size_t block = 0; block < blocks(); ++block) {
      const std::size_t scale = block % kScales.size();
      for (std::size_t m = 0; m < kPlanimetryMethods; ++m) {
        const Spread spread = spread_at(options, results, block, m);
        json.push_back({{"disturbed", disturbance_.variants[block / kScales.size()].name},
                        {"scale", scale + 1},
                        {"location_mm", kScales[scale].location_mm},
                        {"orientation_deg", kScales[scale].orientation_deg},
                        {"method", kVolumeMethods[m].name},
                        {"samples", options.samples},
                        {"volumes", spread.volumes},
                        {"smallest_percent", spread.smallest},
                        {"lower_quartile_percent", spread.lower},
                        {"median_percent", spread.median},
                        {"upper_quartile_percent", spread.upper},
                        {"largest_percent", spread.largest},
                        {"undisturbed_percent", results.at(0).at("error_percent").at(kVolumeMethods[m].name)}});
      }
    }
    return json;
  }

  StudyReport report(const StudyOptions& options, const std::vector<Json>& results) const override {
    StudyReport report;
    for (std::size_t variant = 0; variant < disturbance_.variants.size(); ++variant) {
      for (const std::size_t m : {kPublishedMethod, kQuadric}) add_table(options, results, variant, m, report);
      add_plot(options, results, variant, report);
      add_goals(options, results, variant, report);
    }
    add_pictures(options, report);
    return report;
  }

 private:
  // Case 0 is undisturbed; then come blocks of samples: all scales of the first variant, and so on.
  std::size_t blocks() const { return disturbance_.variants.size() * kScales.size(); }

  static std::size_t block_of(const StudyOptions& options, int index) {
    return static_cast<std::size_t>((index - 1) / options.samples);
  }

  static std::size_t scale_of(const StudyOptions& options, int index) {
    return block_of(options, index) % kScales.size();
  }

  const Variant& variant_of(const StudyOptions& options, int index) const {
    return disturbance_.variants.at(block_of(options, index) / kScales.size());
  }

  SimulateOptions scan_of(const StudyOptions& options, int index) const {
    SimulateOptions scan;
    scan.object = kObject;
    scan.pattern = kPattern;
    scan.frames = kPlanes;
    if (index == 0) return scan;
    const Scale& scale = kScales.at(scale_of(options, index));
    scan.seed = case_seed(options, index);
    scan.steady_ends = variant_of(options, index).steady_ends;
    scan.*disturbance_.location_mm = scale.location_mm;
    scan.*disturbance_.orientation_deg = scale.orientation_deg;
    return scan;
  }

  static Spread spread_at(const StudyOptions& options, const std::vector<Json>& results, std::size_t block,
                          std::size_t method) {
    std::vector<double> errors;
    const auto samples = static_cast<std::size_t>(options.samples);
    for (std::size_t i = 1 + block * samples; i <= (block + 1) * samples; ++i) {
      const Json& error = results.at(i).at("error_percent").at(kVolumeMethods[method].name);
      if (!error.is_null()) errors.push_back(error.get<double>());
    }
    return spread_of(errors);
  }

  void add_table(const StudyOptions& options, const std::vector<Json>& results, std::size_t variant, std::size_t method,
                 StudyReport& report) const {
    const Variant& disturbed = disturbance_.variants[variant];
    StudyTable table;
    table.name = std::string(disturbed.name) + (method == kPublishedMethod ? "-cubic" : "-quadric");
    table.title = std::string("Error of the volume (%), ") + disturbed.label + ": " + kVolumeMethods[method].label +
                  " planimetry";
    table.columns = {"scale",
                     "location +- (mm)",
                     "of the object's size (%)",
                     "orientation +- (degrees)",
                     "smallest",
                     "lower quartile",
                     "median",
                     "upper quartile",
                     "largest",
                     "volumes"};
    for (std::size_t scale = 0; scale < kScales.size(); ++scale) {
      const Spread spread = spread_at(options, results, variant * kScales.size() + scale, method);
      std::vector<std::string> row = {std::to_string(scale + 1), format_rounded(kScales[scale].location_mm, 1),
                                      format_rounded(100.0 * kScales[scale].location_mm / kSize_mm, 1),
                                      format_rounded(kScales[scale].orientation_deg, 1)};
      for (const double error : {spread.smallest, spread.lower, spread.median, spread.upper, spread.largest}) {
        row.push_back(spread.volumes > 0 ? percent_text(error) : "-");
      }
      row.push_back(std::to_string(spread.volumes) + " of " + std::to_string(options.samples));
      table.rows.push_back(std::move(row));
    }
    const Json& undisturbed = results.at(0).at("error_percent").at(kVolumeMethods[method].name);
    if (!undisturbed.is_null()) {
      table.remark = "The same ten planes without disturbance: " + percent_text(undisturbed.get<double>()) + " %. ";
    }
    if (report.tables.empty()) table.remark += disturbance_.remark;
    report.tables.push_back(std::move(table));
  }

  void add_plot(const StudyOptions& options, const std::vector<Json>& results, std::size_t variant,
                StudyReport& report) const {
    const Variant& disturbed = disturbance_.variants[variant];
    StudyPlot plot;
    plot.name = disturbed.name;
    plot.title = std::string(disturbance_.title) + ", " + disturbed.label + ": error, quartile to quartile";
    plot.x_label = "scale";
    plot.y_label = "error (%)";
    for (const std::size_t m : {kPublishedMethod, kQuadric}) {
      StudySeries median{std::string(kVolumeMethods[m].label) + ": median, quartiles", {}, {}, {}};
      StudySeries smallest{std::string(kVolumeMethods[m].label) + ": smallest", {}, {}, {}};
      StudySeries largest{std::string(kVolumeMethods[m].label) + ": largest", {}, {}, {}};
      for (std::size_t scale = 0; scale < kScales.size(); ++scale) {
        const Spread spread = spread_at(options, results, variant * kScales.size() + scale, m);
        if (spread.volumes == 0) continue;
        // Side by side, so that the bars do not hide each other.
        const double x = static_cast<double>(scale + 1) + (m == kPublishedMethod ? -0.05 : 0.05);
        median.points.emplace_back(x, spread.median);
        median.low.push_back(spread.lower);
        median.high.push_back(spread.upper);
        smallest.points.emplace_back(x, spread.smallest);
        largest.points.emplace_back(x, spread.largest);
      }
      for (StudySeries* series : {&median, &smallest, &largest}) plot.series.push_back(std::move(*series));
    }
    report.plots.push_back(std::move(plot));
  }

  void add_goals(const StudyOptions& options, const std::vector<Json>& results, std::size_t variant,
                 StudyReport& report) const {
    const std::string percent = format_rounded(disturbance_.published_percent, 0) + " %";
    for (const std::size_t m : {kPublishedMethod, kQuadric}) {
      const Spread spread = spread_at(options, results, variant * kScales.size() + kPublishedScale, m);
      const bool met = spread.volumes == options.samples &&
                       std::max(std::abs(spread.lower), std::abs(spread.upper)) <= disturbance_.published_percent;
      report.goals.push_back({std::string(disturbance_.variants[variant].label) + ", " + kVolumeMethods[m].label +
                                  " planimetry: quartiles at 5 % of the object's size (scale 3)",
                              "within " + percent + " (published: about +-" + percent + ")",
                              range_text(spread.lower, spread.upper), met});
    }
  }

  void add_pictures(const StudyOptions& options, StudyReport& report) const {
    for (const std::size_t scale : {kPublishedScale, kScales.size() - 1}) {
      const int index = 1 + static_cast<int>(scale) * options.samples;
      report.pictures.push_back({"scan-scale-" + std::to_string(scale + 1),
                                 "the first sample of scale " + std::to_string(scale + 1) +
                                     ": planes as recorded, their outlines and the surface through them",
                                 scan_picture(scan_of(options, index))});
    }
  }

  Disturbance disturbance_;
};

}  // namespace

const Study& unsteady_study() {
  static const DisturbanceStudy study(
      {"2.13",
       "unsteady hand",
       &SimulateOptions::jitter_mm,
       &SimulateOptions::jitter_deg,
       1.0,
       "Planes are where they are recorded, but neither evenly spaced nor parallel. The source document prints the "
       "distribution as a picture and says: about +-1 % for unsteadiness of up to 5 % of the object's size (scale 3). "
       "It "
       "also says that the first and last planes were always at the object's extremities: so are they with steady "
       "ends. "
       "Where they are disturbed too, half of them miss the object, and what lies between its end and the next plane "
       "is lost: 3.4 % of an ellipsoid in nine gaps.",
       {{"ends-steady", "ends at the extremities", true}, {"all-disturbed", "all planes disturbed", false}}});
  return study;
}

const Study& misregistration_study() {
  static const DisturbanceStudy study(
      {"2.14",
       "mis-registration",
       &SimulateOptions::misregister_mm,
       &SimulateOptions::misregister_deg,
       10.0,
       "Planes are not where they are recorded. The source document prints the distribution as a picture and says: "
       "about +-10 % for errors of up to 5 % of the object's size (scale 3).",
       {{"all-disturbed", "all planes", false}}});
  return study;
}

}  // namespace fathom
