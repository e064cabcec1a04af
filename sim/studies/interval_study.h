#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/studies/study.h"

namespace fathom {

/// Study `interval`: how often 95 % intervals hold the true volume. A case is a row of Treece 2000, table 2.1, with 5
/// to 20 sections; each of its samples is an exam with tracker noise of 0 to 0.3 mm and scatter of outlines of 0 to 0.3
/// mm (organs of 2 cm).
const Study& interval_study();

/// Exams of one row and number of sections.
struct IntervalCase {
  std::string object;
  std::string pattern;
  int sections = 0;  ///< frames of the scan
};
std::vector<IntervalCase> interval_cases();

/// Of some exams. Widths are sums of the intervals' widths, in percent of the true volume.
struct IntervalCounts {
  int exams = 0;
  int redrawn = 0;  ///< noise had turned an end plane away, which the program refuses: another exam was drawn
  int covered = 0;  ///< with the scatter of outlines given
  double width_percent = 0.0;
  int judged_covered = 0;  ///< with the scatter judged by the measurement
  double judged_width_percent = 0.0;
  double oracle_width_percent = 0.0;  ///< of intervals made with the true spread of the errors of each exam

  IntervalCounts& operator+=(const IntervalCounts& other);
};
IntervalCounts measure_intervals(const IntervalCase& of, int exams, std::uint64_t seed);

/// `counts` of all cases, in their order.
StudyReport interval_report(const std::vector<IntervalCounts>& counts);

}  // namespace fathom
