#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"

namespace fathom {

/// How often 95 % intervals hold the true volume, over simulated exams of the 14 rows of Treece 2000, table 2.1, with
/// 5 to 20 sections, tracker noise of 0 to 0.3 mm and scatter of outlines of 0 to 0.3 mm (organs of 2 cm).
struct IntervalStudyOptions {
  int exams = 2000;
  std::uint64_t seed = 1;
  bool outline_known = true;  ///< whether the scatter of outlines is given to the measurement, or judged by it
};

struct IntervalStudyRow {
  std::string object;
  std::string pattern;
  int exams = 0;
  int covered = 0;
  double width_percent = 0.0;         ///< mean width of the intervals, of the true volume
  double oracle_width_percent = 0.0;  ///< of those made with the true spread of the errors of each exam
};

/// One line for each row of the table. Throws Cancelled.
std::vector<IntervalStudyRow> interval_study(const IntervalStudyOptions& options = {}, const Progress& progress = {});

/// Sum of all rows, named "all".
IntervalStudyRow pooled(const std::vector<IntervalStudyRow>& rows);

std::string interval_study_text(const std::vector<IntervalStudyRow>& rows);

}  // namespace fathom
