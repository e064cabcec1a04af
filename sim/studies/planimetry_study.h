#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "sim/simulate.h"

namespace fathom {

/// The methods of planimetry in the order of Treece 2000, table 2.1, with their names in results.
inline constexpr std::array<const char*, 3> kPlanimetryMethods = {"linear_planimetry", "cubic_planimetry",
                                                                  "cubic_planimetry_3d"};

/// How one method does on one row of the table.
struct PlanimetryAccuracy {
  std::vector<double> error_percent;          ///< signed, for 4, 5, ... 20 planes
  std::optional<int> planes_below_1_percent;  ///< the fewest for which this and every larger number stay below 1 %
  std::optional<int> first_below_1_percent;   ///< the fewest for which this number is below 1 %
  double error_percent_at_20 = 0.0;           ///< signed
  double rms_percent_17_to_20 = 0.0;          ///< with the sign of the mean of the four errors
};

/// What the source document prints for one method; empty where it needs more than 20 planes.
struct PublishedAccuracy {
  std::optional<int> planes_below_1_percent;
  double error_percent_at_20 = 0.0;
};

/// One row of Treece 2000, table 2.1, columns 1 to 3.
struct PlanimetryRow {
  std::string object;
  std::string pattern;
  std::array<PlanimetryAccuracy, 3> methods;
  std::array<PublishedAccuracy, 3> published;
};

inline constexpr int kFewestPlanes = 4;
inline constexpr int kMostPlanes = 20;

/// Object and pattern of every row, with the published figures; `methods` are empty.
std::vector<PlanimetryRow> published_planimetry_rows();

/// Scans with 4 to 20 planes and measures the true outlines by every method. Takes `object`, `pattern` and `published`
/// from `row`.
PlanimetryRow measure_planimetry_row(const PlanimetryRow& row);

/// All rows. Throws Cancelled.
std::vector<PlanimetryRow> planimetry_table(const Progress& progress = {});

/// As a table in Markdown, published figures in brackets.
std::string planimetry_table_text(const std::vector<PlanimetryRow>& rows);

}  // namespace fathom
