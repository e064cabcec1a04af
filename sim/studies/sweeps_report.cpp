#include <algorithm>
#include <cmath>
#include <map>

#include "core/numbers.h"
#include "sim/studies/scan_picture.h"
#include "sim/studies/sweeps_table.h"

namespace fathom {

namespace {

constexpr double kCellsAsPublished = 0.9;
constexpr double kWithin_percent = 2.0;
constexpr double kSeen_mm = 0.1;

constexpr const char* kLimb =
    "the loss is inside the middle sweep, where a limb that lies along the images is entered between two frames and "
    "its area jumps; the object is also harder here than the published one, as linear planimetry shows";
constexpr const char* kBothSides =
    "planes cut the middle sweep on both sides, so that its area rises like a root at both ends, which the ends of the "
    "cubic spline miss";

/// Why a cell needs more sections than published.
const char* reason_of(const SweepsCell& cell) {
  static const std::map<std::string, const char*> kReasons = {
      {"ellipsoid sweeps-c",
       "the images turn by 60 degrees on the way: the first frame just cuts its part, the next "
       "ones leave it again"},
      {"ellipsoid sweeps-d", kBothSides},
      {"ellipsoid sweeps-h", kBothSides},
      {"box sweeps-e", "edges of the box are met in steps; ends that carry the curvature on overshoot them"},
      {"box sweeps-f", "edges of the box are met in steps"},
      {"box sweeps-h", "edges of the box are met in steps"}};
  if (cell.object == "branching") return kLimb;
  const auto reason = kReasons.find(cell.object + " " + cell.pattern);
  return reason == kReasons.end() ? "no reason is known" : reason->second;
}

std::string sections_text(const std::optional<SweepsMeasurement>& measurement) {
  return measurement ? std::to_string(measurement->sections) : "-";
}

bool as_published(const SweepsCell& cell, const std::optional<SweepsMeasurement>& sustained) {
  return sustained && sustained->sections <= cell.published_sections;
}

StudyTable sections_table(const std::vector<SweepsCell>& cells) {
  StudyTable table;
  table.name = "sections";
  table.title = "Sections for an error within 2 %";
  table.columns = {"object", "pattern", "2D cubic", "quadric", "linear there (%)", "2D cubic there (%)"};
  table.remark =
      "Sections are frames that show the object where their sweep is used. From this number up to 23 frames a sweep "
      "the "
      "error stays within 2 %; in brackets: published, linear planimetry's error without its sign. The published "
      "patterns are known as pictures only.";
  for (const SweepsCell& cell : cells) {
    const SweepsMeasurement none{.linear_percent = std::nan(""), .cubic_percent = std::nan("")};
    const SweepsMeasurement& fewest = cell.sustained ? *cell.sustained : none;
    table.rows.push_back(
        {cell.object, cell.pattern,
         sections_text(cell.sustained) + " (" + std::to_string(cell.published_sections) + ")",
         sections_text(cell.sustained_quadric),
         format_signed(fewest.linear_percent, 1) + " (" + format_rounded(cell.published_linear, 1) + ")",
         format_signed(fewest.cubic_percent, 2)});
  }
  return table;
}

StudyTable errors_table(const std::vector<SweepsCell>& cells) {
  StudyTable table;
  table.name = "errors";
  table.title = "Errors (%) with about the published number of sections, and with 23 frames a sweep";
  table.columns = {"object",  "pattern", "linear",          "2D cubic",         "quadric",
                   "surface", "missing", "linear, 23 each", "2D cubic, 23 each"};
  table.remark =
      "Surface: by maximal discs, of second order, cut by the planes; in brackets the published, without its sign. "
      "Missing: what the measurement itself says is lost between the outer sections and the planes.";
  for (const SweepsCell& cell : cells) {
    const SweepsMeasurement& at = cell.at_published;
    const SweepsMeasurement& most = cell.measurements.back();
    table.rows.push_back(
        {cell.object, cell.pattern, format_signed(at.linear_percent, 1), format_signed(at.cubic_percent, 2),
         format_signed(at.quadric_percent, 2),
         format_signed(cell.surface_percent, 1) + " (" + format_rounded(cell.published_surface, 1) + ")",
         format_rounded(at.missing_percent, 2), format_signed(most.linear_percent, 2),
         format_signed(most.cubic_percent, 2)});
  }
  return table;
}

StudyTable worse_table(const std::vector<SweepsCell>& cells) {
  StudyTable table;
  table.name = "worse";
  table.title = "Cells that need more sections than published, and why";
  table.columns = {"object", "pattern", "sections more, 2D cubic", "quadric", "why"};
  const auto more = [](const SweepsCell& cell, const std::optional<SweepsMeasurement>& sustained) {
    if (!sustained) return std::string("not within the limits");
    return std::to_string(std::max(0, sustained->sections - cell.published_sections));
  };
  for (const SweepsCell& cell : cells) {
    if (as_published(cell, cell.sustained) && as_published(cell, cell.sustained_quadric)) continue;
    table.rows.push_back(
        {cell.object, cell.pattern, more(cell, cell.sustained), more(cell, cell.sustained_quadric), reason_of(cell)});
  }
  return table;
}

StudyPlot error_plot(const SweepsCell& cell) {
  StudyPlot plot;
  plot.name = "error-" + cell.object + "-" + cell.pattern;
  plot.title = cell.object + " " + cell.pattern;
  plot.x_label = "sections";
  plot.y_label = "error of volume (%)";
  const std::pair<const char*, double SweepsMeasurement::*> lines[] = {
      {"linear", &SweepsMeasurement::linear_percent},
      {"2D cubic", &SweepsMeasurement::cubic_percent},
      {"quadric", &SweepsMeasurement::quadric_percent}};
  for (const auto& [name, percent] : lines) {
    StudySeries series{name, {}, {}, {}};
    for (const SweepsMeasurement& m : cell.measurements) {
      if (std::isfinite(m.*percent)) series.points.emplace_back(m.sections, m.*percent);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void add_pictures(const std::vector<SweepsCell>& cells, StudyReport& report) {
  for (const SweepsCell& cell : cells) {
    SimulateOptions scan;
    scan.object = cell.object;
    scan.pattern = cell.pattern;
    scan.frames = cell.at_published.frames;
    report.pictures.push_back(
        {"scan-" + cell.object + "-" + cell.pattern, cell.object + ", " + cell.pattern, scan_picture(scan)});
  }
}

StudyGoal count_goal(const std::vector<SweepsCell>& cells, const char* method,
                     std::optional<SweepsMeasurement> SweepsCell::*sustained) {
  const auto met = std::count_if(cells.begin(), cells.end(),
                                 [&](const SweepsCell& cell) { return as_published(cell, cell.*sustained); });
  const auto wanted = std::lround(std::ceil(kCellsAsPublished * static_cast<double>(cells.size())));
  return {std::string("sections for an error within 2 %, ") + method,
          "at most as published in 90 % of the cells (" + std::to_string(wanted) + ")",
          "in " + std::to_string(met) + " of " + std::to_string(cells.size()), met >= wanted};
}

}  // namespace

StudyReport sweeps_report(const std::vector<SweepsCell>& cells) {
  StudyReport report;
  report.tables = {sections_table(cells), errors_table(cells), worse_table(cells)};
  for (const SweepsCell& cell : cells) report.plots.push_back(error_plot(cell));
  add_pictures(cells, report);
  report.goals.push_back(count_goal(cells, "2D cubic", &SweepsCell::sustained));
  report.goals.push_back(count_goal(cells, "quadric", &SweepsCell::sustained_quadric));
  double largest_percent = 0.0;
  double cut_off_mm = 0.0;
  for (const SweepsCell& cell : cells) {
    const SweepsMeasurement& most = cell.measurements.back();
    largest_percent = std::max(largest_percent, std::abs(most.cubic_percent));
    cut_off_mm = std::max(cut_off_mm, most.cut_off_mm);
  }
  report.goals.push_back({"2D cubic with 23 frames a sweep", "within 2 % in all cells",
                          "largest error " + format_rounded(largest_percent, 2) + " %",
                          largest_percent <= kWithin_percent});
  report.goals.push_back({"the images show the whole object", "less than 0.1 mm of border within it",
                          format_rounded(cut_off_mm, 3) + " mm", cut_off_mm < kSeen_mm});
  return report;
}

}  // namespace fathom
