#include <algorithm>
#include <cmath>
#include <map>

#include "core/numbers.h"
#include "sim/studies/interval_study.h"

namespace fathom {

namespace {

constexpr double kLeastCovered_percent = 93.0;
constexpr double kMostCovered_percent = 97.0;
constexpr double kWidthOfOracle = 1.5;

double share_percent(int part, int whole) { return 100.0 * part / std::max(whole, 1); }

double mean(double sum, const IntervalCounts& counts) { return sum / std::max(counts.exams, 1); }

std::vector<std::string> cells_of(std::vector<std::string> heads, const IntervalCounts& counts) {
  std::vector<std::string> cells = std::move(heads);
  for (const std::string& cell :
       {std::to_string(counts.exams), format_rounded(share_percent(counts.covered, counts.exams), 1),
        format_rounded(mean(counts.width_percent, counts), 2),
        format_rounded(mean(counts.oracle_width_percent, counts), 2),
        format_rounded(counts.width_percent / counts.oracle_width_percent, 2),
        format_rounded(share_percent(counts.judged_covered, counts.exams), 1),
        format_rounded(mean(counts.judged_width_percent, counts), 2)}) {
    cells.push_back(cell);
  }
  return cells;
}

StudyTable table_of(const char* name, const char* title, std::vector<std::string> heads) {
  StudyTable table;
  table.name = name;
  table.title = title;
  table.columns = std::move(heads);
  for (const char* column : {"exams", "covered (%)", "width (%)", "oracle's width (%)", "ratio",
                             "covered, scatter judged (%)", "width (%)"}) {
    table.columns.emplace_back(column);
  }
  return table;
}

StudyPlot coverage_plot(const std::map<int, IntervalCounts>& by_sections) {
  StudyPlot plot;
  plot.name = "coverage";
  plot.title = "Exams whose 95 % interval holds the true volume";
  plot.x_label = "sections";
  plot.y_label = "exams (%)";
  StudySeries given{"scatter of outlines given", {}, {}, {}};
  StudySeries judged{"scatter judged", {}, {}, {}};
  for (const auto& [sections, counts] : by_sections) {
    given.points.emplace_back(sections, share_percent(counts.covered, counts.exams));
    judged.points.emplace_back(sections, share_percent(counts.judged_covered, counts.exams));
  }
  plot.series = {given, judged};
  plot.y_range = {80.0, 100.0};
  return plot;
}

StudyGoal coverage_goal(const char* what, int covered, const IntervalCounts& all, double most_percent) {
  const double percent = share_percent(covered, all.exams);
  return {what, format_rounded(kLeastCovered_percent, 0) + " to " + format_rounded(most_percent, 0) + " %",
          format_rounded(percent, 1) + " % of " + std::to_string(all.exams),
          kLeastCovered_percent <= percent && percent <= most_percent};
}

}  // namespace

StudyReport interval_report(const std::vector<IntervalCounts>& counts) {
  StudyTable by_row = table_of("rows", "Intervals of the rows of table 2.1", {"object", "pattern"});
  by_row.remark =
      "Each exam has tracker noise of 0 to 0.3 mm (0.6 degrees for each mm) and outlines that are off by 0 to 0.3 mm. "
      "Width: mean, of the true volume. The oracle knows the spread of the errors of the same exam. Scatter judged: "
      "the "
      "measurement is not told how far outlines are off, and judges by how unevenly sections follow each other.";
  const std::vector<IntervalCase> cases = interval_cases();
  std::map<int, IntervalCounts> by_sections;
  IntervalCounts all;
  IntervalCounts row;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    row += counts.at(i);
    all += counts[i];
    by_sections[cases[i].sections] += counts[i];
    const bool last =
        i + 1 == cases.size() || cases[i + 1].object != cases[i].object || cases[i + 1].pattern != cases[i].pattern;
    if (!last) continue;
    by_row.rows.push_back(cells_of({cases[i].object, cases[i].pattern}, row));
    row = {};
  }
  by_row.rows.push_back(cells_of({"all", ""}, all));
  StudyTable sections = table_of("sections", "Intervals by the number of sections", {"sections"});
  for (const auto& [number, of] : by_sections) sections.rows.push_back(cells_of({std::to_string(number)}, of));

  StudyReport report;
  report.tables = {by_row, sections};
  report.plots = {coverage_plot(by_sections)};
  report.goals.push_back(coverage_goal("intervals that hold the true volume", all.covered, all, kMostCovered_percent));
  report.goals.push_back(coverage_goal("the same, scatter of outlines judged", all.judged_covered, all, 100.0));
  const double ratio = all.width_percent / all.oracle_width_percent;
  report.goals.push_back({"width of the intervals, of an oracle's", "<= " + format_rounded(kWidthOfOracle, 1),
                          format_rounded(ratio, 2), ratio <= kWidthOfOracle});
  return report;
}

}  // namespace fathom
