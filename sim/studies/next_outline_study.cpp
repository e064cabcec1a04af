#include "sim/studies/next_outline_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "measurement/missing_ends.h"
#include "measurement/planimetry.h"
#include "measurement/where_next.h"
#include "sim/studies/planimetry_study.h"

namespace fathom {

namespace {

constexpr int kFrames = 401;
constexpr int kFewestSections = 3;
constexpr double kGoalPercent = 1.0;
constexpr std::array<int, 3> kSections{7, 11, 21};
constexpr double kMissing = 0.1;

// A scan of a row, with the section of every frame.
struct DenseScan {
  SimulatedScan scan;
  std::unique_ptr<FrameLocator> locator;
  std::vector<CrossSection> sections;

  explicit DenseScan(const PlanimetryRow& row) {
    SimulateOptions options;
    options.object = row.object;
    options.pattern = row.pattern;
    options.frames = kFrames;
    scan = simulate(options);
    locator = std::make_unique<FrameLocator>(*scan.recording, scan.calibration);
    sections = cross_sections(scan.outlines.front(), *locator, nullptr);
  }

  double percent(double volume_ml) const { return 100.0 * (volume_ml / scan.truth.volume_ml - 1.0); }

  std::vector<CrossSection> evenly(int count, double from, double to) const {
    std::vector<CrossSection> chosen;
    const double last = static_cast<double>(sections.size() - 1);
    for (int i = 0; i < count; ++i) {
      const double share = from + (to - from) * i / (count - 1);
      chosen.push_back(sections[static_cast<std::size_t>(std::lround(last * share))]);
    }
    return chosen;
  }

  // Between sections in the order of frames, that of `frame` or the next that the object has.
  void insert(int frame, std::vector<CrossSection>& chosen) const {
    const auto by_frame = [](const CrossSection& section, int wanted) { return section.frame < wanted; };
    const auto found = std::lower_bound(sections.begin(), sections.end(), frame, by_frame);
    if (found != sections.end()) chosen.insert(std::lower_bound(chosen.begin(), chosen.end(), frame, by_frame), *found);
  }
};

// The smallest count from which on all errors stay small; `errors` are for kFewestSections and on.
std::optional<int> sustained(const std::vector<double>& errors) {
  std::optional<int> count;
  for (std::size_t i = errors.size(); i-- > 0 && std::abs(errors[i]) < kGoalPercent;) {
    count = kFewestSections + static_cast<int>(i);
  }
  return count;
}

std::string count_text(const std::optional<int>& count) { return count ? std::to_string(*count) : "-"; }

}  // namespace

std::vector<NextOutlineRow> next_outline_study() {
  std::vector<NextOutlineRow> rows;
  for (const PlanimetryRow& printed : published_planimetry_rows()) {
    const DenseScan dense(printed);
    std::vector<double> asked;
    std::vector<double> even;
    std::vector<double> even_cubic;
    std::vector<CrossSection> chosen = dense.evenly(kFewestSections, 0.0, 1.0);
    for (int count = kFewestSections; count <= kMostPlanes; ++count) {
      asked.push_back(dense.percent(quadric_planimetry_ml(chosen)));
      const auto spaced = dense.evenly(count, 0.0, 1.0);
      even.push_back(dense.percent(quadric_planimetry_ml(spaced)));
      even_cubic.push_back(dense.percent(cubic_planimetry_ml(spaced)));
      if (const auto next = where_next(chosen, *dense.locator)) dense.insert(next->frame, chosen);
    }
    rows.push_back({printed.object, printed.pattern, sustained(asked), sustained(even), sustained(even_cubic)});
  }
  return rows;
}

std::string next_outline_text(const std::vector<NextOutlineRow>& rows) {
  std::string text =
      "| object | pattern | where asked | evenly spaced | evenly spaced, cubic planimetry |\n"
      "| --- | --- | --- | --- | --- |\n";
  for (const NextOutlineRow& row : rows) {
    text += "| " + row.object + " | " + row.pattern + " | " + count_text(row.asked) + " | " + count_text(row.even) +
            " | " + count_text(row.even_cubic) + " |\n";
  }
  return text;
}

std::vector<MissingEndsRow> missing_ends_study() {
  std::vector<MissingEndsRow> rows;
  for (const PlanimetryRow& printed : published_planimetry_rows()) {
    const DenseScan dense(printed);
    MissingEndsRow row{printed.object, printed.pattern, {}, {}, true};
    for (std::size_t i = 0; i < kSections.size(); ++i) {
      const auto sections = dense.evenly(kSections[i], kMissing, 1.0 - kMissing);
      double volume_ml = quadric_planimetry_ml(sections);
      row.measured_percent[i] = dense.percent(volume_ml);
      for (const MissingEnd& end : missing_ends(sections, {}, *dense.locator)) {
        row.both_told = row.both_told && end.volume_ml.has_value();
        volume_ml += end.volume_ml.value_or(0.0);
      }
      row.corrected_percent[i] = dense.percent(volume_ml);
    }
    rows.push_back(row);
  }
  return rows;
}

std::string missing_ends_text(const std::vector<MissingEndsRow>& rows) {
  std::string text =
      "| object | pattern | 7 sections: measured, % | corrected, % | 11: measured | corrected | 21: measured | "
      "corrected |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const MissingEndsRow& row : rows) {
    text += "| " + row.object + " | " + row.pattern + (row.both_told ? "" : " (one end cannot be told)");
    for (std::size_t i = 0; i < kSections.size(); ++i) {
      char cells[64];
      std::snprintf(cells, sizeof cells, " | %+.2f | %+.2f", row.measured_percent[i], row.corrected_percent[i]);
      text += cells;
    }
    text += " |\n";
  }
  return text;
}

}  // namespace fathom
