#include "sim/studies/chain_study.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/numbers.h"
#include "sim/studies/chain_links.h"
#include "sim/studies/scan_picture.h"
#include "sim/studies/study_json.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kSections = 10;
constexpr double kGoal_percent = 2.0;

std::vector<ChainScan> scans() {
  std::vector<ChainScan> scans;
  for (const char* object : {"ellipsoid", "glove", "bladder", "kidney"}) {
    for (const char* pattern : {"free", "fan"}) scans.push_back({object, pattern});
  }
  return scans;
}

bool is_organ(const ChainScan& scan) { return scan.object == "bladder" || scan.object == "kidney"; }

Json json_of(const ChainScan& scan, const ChainVolumes& volumes) {
  Json links;
  for (std::size_t i = 0; i < kChainLinks.size(); ++i) links[kChainLinks[i]] = number_json(volumes.link_ml[i]);
  return {{"object", scan.object},
          {"pattern", scan.pattern},
          {"true_ml", volumes.true_ml},
          {"links_ml", std::move(links)},
          {"all_ml", number_json(volumes.all_ml)},
          {"all_but_outlining_ml", number_json(volumes.all_but_outlining_ml)},
          {"all_cubic_ml", number_json(volumes.all_cubic_ml)},
          {"interval_ml", {number_json(volumes.low_ml), number_json(volumes.high_ml)}}};
}

/// Root mean square of what is finite, and how many that are.
struct Rms {
  double squares = 0.0;
  int count = 0;
  void add(double value) {
    if (!std::isfinite(value)) return;
    squares += value * value;
    ++count;
  }
  double value() const { return std::sqrt(squares / std::max(1, count)); }
};

/// The budget of some scans; errors in percent of the true volume.
struct Budget {
  Rms links[kChainLinks.size()];  ///< the first: error; the others: what a link changes
  Rms all;
  Rms but_outlining;
  Rms cubic;
  int volumes = 0;
  int without = 0;  ///< no volume, or no interval
  int covered = 0;
  double width_percent = 0.0;  ///< sum

  void add(const Json& scan) {
    const double true_ml = scan.at("true_ml").get<double>();
    const double percent = 100.0 / true_ml;
    const double exact_ml = number_of(scan.at("links_ml").at(kChainLinks[0]));
    links[0].add(percent * (exact_ml - true_ml));
    for (std::size_t i = 1; i < kChainLinks.size(); ++i) {
      links[i].add(percent * (number_of(scan.at("links_ml").at(kChainLinks[i])) - exact_ml));
    }
    all.add(percent * (number_of(scan.at("all_ml")) - true_ml));
    but_outlining.add(percent * (number_of(scan.at("all_but_outlining_ml")) - true_ml));
    cubic.add(percent * (number_of(scan.at("all_cubic_ml")) - true_ml));
    ++volumes;
    const double low = number_of(scan.at("interval_ml").at(0));
    const double high = number_of(scan.at("interval_ml").at(1));
    if (!std::isfinite(low)) {
      ++without;
      return;
    }
    if (low <= true_ml && true_ml <= high) ++covered;
    width_percent += percent * (high - low);
  }

  double sum_of_links() const {
    double squares = 0.0;
    for (const Rms& link : links) squares += link.value() * link.value();
    return std::sqrt(squares);
  }
};

std::vector<Budget> budgets_of(const std::vector<Json>& results) {
  std::vector<Budget> budgets(scans().size());
  for (const Json& result : results) {
    for (std::size_t i = 0; i < budgets.size(); ++i) budgets[i].add(result.at("scans").at(i));
  }
  return budgets;
}

Budget pooled(const std::vector<Json>& results) {
  Budget all;
  for (const Json& result : results) {
    for (const Json& scan : result.at("scans")) all.add(scan);
  }
  return all;
}

std::vector<std::string> budget_cells(const std::string& object, const std::string& pattern, const Budget& budget) {
  std::vector<std::string> cells = {object, pattern};
  for (const Rms& link : budget.links) cells.push_back(format_rounded(link.value(), 2));
  for (const double value :
       {budget.sum_of_links(), budget.all.value(), budget.but_outlining.value(), budget.cubic.value()}) {
    cells.push_back(format_rounded(value, 2));
  }
  const int known = budget.volumes - budget.without;
  cells.push_back(std::to_string(budget.covered) + " of " + std::to_string(known));
  cells.push_back(format_rounded(budget.width_percent / std::max(1, known), 1));
  cells.push_back(std::to_string(budget.without));
  return cells;
}

StudyTable budget_table(const std::vector<Json>& results) {
  StudyTable table;
  table.name = "budget";
  table.title = "Error budget of a volume: rms, in percent of the true volume";
  table.columns = {"object", "pattern"};
  for (const char* link : kChainLinks) table.columns.emplace_back(link);
  for (const char* column : {"root of sum of squares", "all together", "all but outlining", "all, 2D cubic",
                             "held by the 95 % interval", "interval's width (%)", "refused"}) {
    table.columns.emplace_back(column);
  }
  const ChainErrors errors;
  table.remark =
      "Quadric planimetry of " + std::to_string(kSections) +
      " sections. Sections: the error with everything else true. Tracker: " + format_rounded(errors.tracker_mm, 2) +
      " mm and 0.15 degrees of noise, rms, in the organ's scan. Calibration and latency: as found from images "
      "of a registered wire phantom by the same tracker. Outlining: outlines too large or too small by " +
      format_rounded(errors.outline_mm, 1) +
      " mm (standard deviation), from section to section by chance. Pixels: points on whole pixels. The "
      "ellipsoid and the glove are 2 cm large, so that 0.3 mm are much; the organs are of their own size. Refused: "
      "noise turned an "
      "end section's plane away, and the program says that it has no volume.";
  const std::vector<Budget> budgets = budgets_of(results);
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    table.rows.push_back(budget_cells(scans()[i].object, scans()[i].pattern, budgets[i]));
  }
  table.rows.push_back(budget_cells("all", "", pooled(results)));
  return table;
}

StudyTable systems_table(const std::vector<Json>& results) {
  Rms point;
  Rms latency;
  double worst_mm = 0.0;
  double worst_ms = 0.0;
  for (const Json& result : results) {
    point.add(result.at("point_mm").get<double>());
    latency.add(result.at("latency_error_ms").get<double>());
    worst_mm = std::max(worst_mm, result.at("point_mm").get<double>());
    worst_ms = std::max(worst_ms, std::abs(result.at("latency_error_ms").get<double>()));
  }
  StudyTable table;
  table.name = "systems";
  table.title = "The systems' calibrations";
  table.columns = {"systems", "error over the image, rms (mm)", "worst (mm)", "latency, rms (ms)", "worst (ms)"};
  table.rows = {{std::to_string(results.size()), format_rounded(point.value(), 3), format_rounded(worst_mm, 3),
                 format_rounded(latency.value(), 2), format_rounded(worst_ms, 2)}};
  return table;
}

/// What each link contributes, an object a line.
StudyPlot budget_plot(const std::vector<Json>& results) {
  StudyPlot plot;
  plot.name = "budget";
  plot.title = "What each link contributes: 1 sections, 2 tracker, 3 calibration, 4 latency, 5 outlining, 6 pixels";
  plot.x_label = "link";
  plot.y_label = "rms (% of the volume)";
  const std::vector<Budget> budgets = budgets_of(results);
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    StudySeries series{scans()[i].object + " " + scans()[i].pattern, {}, {}, {}};
    for (std::size_t link = 0; link < kChainLinks.size(); ++link) {
      series.points.emplace_back(static_cast<double>(link + 1), budgets[i].links[link].value());
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

/// The worst of the organs, or of the test objects.
StudyGoal worst_goal(const std::vector<Json>& results, bool organs, Rms Budget::*error, std::string what) {
  const std::vector<Budget> budgets = budgets_of(results);
  double worst = 0.0;
  std::string where;
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    const ChainScan scan = scans()[i];
    if (is_organ(scan) != organs || (budgets[i].*error).value() <= worst) continue;
    worst = (budgets[i].*error).value();
    where = scan.object + " " + scan.pattern;
  }
  return {std::move(what), "<= 2 % rms", format_rounded(worst, 2) + " %, " + where, worst <= kGoal_percent};
}

void add_goals(const std::vector<Json>& results, StudyReport& report) {
  report.goals.push_back(
      worst_goal(results, true, &Budget::all, "error of an organ's volume, all links, 0.25 mm of noise"));
  report.goals.push_back(worst_goal(results, false, &Budget::but_outlining,
                                    "the same of objects of 2 cm, all links but the scatter of outlines"));
  const Budget all = pooled(results);
  const double covered = 100.0 * all.covered / std::max(1, all.volumes - all.without);
  report.goals.push_back({"95 % intervals that hold the true volume", ">= 93 %",
                          format_rounded(covered, 1) + " % of " + std::to_string(all.volumes - all.without),
                          covered >= 93.0});
}

class ChainStudy final : public Study {
 public:
  std::string name() const override { return "chain"; }
  std::string title() const override { return "the whole system, and what each link adds to the error"; }
  int cases(const StudyOptions& options) const override { return options.samples; }
  std::string case_name(const StudyOptions&, int index) const override { return "system " + std::to_string(index + 1); }

  Json run_case(const StudyOptions& options, int index) const override {
    const std::uint64_t seed = case_seed(options, index);
    const MeasuringSystem system({}, seed);
    Json measured = Json::array();
    const std::vector<ChainScan> all = scans();
    for (std::size_t i = 0; i < all.size(); ++i) {
      measured.push_back(json_of(all[i], system.measure(all[i], kSections, seed + 10 * (i + 1))));
    }
    return {{"point_mm", system.point_mm()},
            {"latency_error_ms", 1e3 * system.latency_error_s()},
            {"scans", std::move(measured)}};
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    const std::vector<Budget> budgets = budgets_of(results);
    for (std::size_t i = 0; i < budgets.size(); ++i) {
      const Budget& budget = budgets[i];
      Json links;
      for (std::size_t k = 0; k < kChainLinks.size(); ++k) links[kChainLinks[k]] = budget.links[k].value();
      json.push_back({{"object", scans()[i].object},
                      {"pattern", scans()[i].pattern},
                      {"links_rms_percent", std::move(links)},
                      {"sum_of_squares_percent", budget.sum_of_links()},
                      {"all_rms_percent", budget.all.value()},
                      {"all_but_outlining_rms_percent", budget.but_outlining.value()},
                      {"all_cubic_rms_percent", budget.cubic.value()},
                      {"covered", budget.covered},
                      {"volumes", budget.volumes}});
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    StudyReport report;
    report.tables = {budget_table(results), systems_table(results)};
    report.plots = {budget_plot(results)};
    for (const ChainScan& scan : scans()) {
      SimulateOptions options;
      options.object = scan.object;
      options.pattern = scan.pattern;
      options.frames = kSections;
      report.pictures.push_back(
          {"scan-" + scan.object + "-" + scan.pattern, scan.object + ", " + scan.pattern, scan_picture(options)});
    }
    add_goals(results, report);
    return report;
  }
};

}  // namespace

const Study& chain_study() {
  static const ChainStudy study;
  return study;
}

}  // namespace fathom
