#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/simulate.h"

namespace fathom {

/// A way to measure a volume, with its names in results and for readers.
struct VolumeMethod {
  const char* name;
  const char* label;
};

/// In the order of Treece 2000, table 2.1, each family followed by the one of higher order that is not in it.
inline constexpr std::array<VolumeMethod, 8> kVolumeMethods = {{{"linear_planimetry", "linear"},
                                                                {"cubic_planimetry", "2D cubic"},
                                                                {"cubic_planimetry_3d", "3D cubic"},
                                                                {"cubic_planimetry_quadric", "quadric"},
                                                                {"shape_based", "shape-based"},
                                                                {"centroid_guided", "centroid-guided"},
                                                                {"disc_guided", "disc-guided"},
                                                                {"disc_guided_curved", "disc-guided, curved"}}};
inline constexpr std::size_t kPlanimetryMethods = 4;  ///< the first ones; the others are surfaces

/// How one method does on one row of the table.
struct MethodAccuracy {
  std::vector<double> error_percent;          ///< signed, for 4, 5, ... 20 planes; not a number without a volume
  std::optional<int> planes_below_1_percent;  ///< the fewest for which this and every larger number stay below 1 %
  std::optional<int> first_below_1_percent;   ///< the fewest for which this number is below 1 %
  double error_percent_at_20 = 0.0;           ///< signed
  double rms_percent_17_to_20 = 0.0;          ///< with the sign of the mean of the four errors
};

/// What the source document prints for one method; no planes where it needs more than 20.
struct PublishedAccuracy {
  std::optional<int> planes_below_1_percent;
  double error_percent_at_20 = 0.0;
};

/// One row of Treece 2000, table 2.1; arrays are in the order of kVolumeMethods.
struct PlanimetryRow {
  std::string object;
  std::string pattern;
  std::array<std::optional<PublishedAccuracy>, kVolumeMethods.size()> published;
};

inline constexpr int kFewestPlanes = 4;
inline constexpr int kMostPlanes = 20;

/// Object and pattern of every row, with the published figures.
std::vector<PlanimetryRow> published_planimetry_rows();

/// Rows in which cubic planimetry meets an edge, a tip or a concavity in many planes, so that its count depends on the
/// exact scan, which is published only as a picture.
bool is_rough(const PlanimetryRow& row);

/// What the methods make of one scan.
struct ScanVolumes {
  double true_ml = 0.0;
  std::array<std::optional<double>, kVolumeMethods.size()> volume_ml;
};

/// Measures the true outlines by planimetry and, if asked for, by surfaces of kSurfaceStudySpacing_mm.
ScanVolumes measure_scan(const SimulateOptions& options, bool surfaces);

/// `errors` are in percent, signed, for kFewestPlanes to kMostPlanes; not a number counts as none below 1 %.
MethodAccuracy accuracy_of(std::vector<double> errors);

/// Scans with 4 to 20 planes and measures by planimetry: as many as kPlanimetryMethods.
std::vector<MethodAccuracy> measure_planimetry_row(const PlanimetryRow& row);

}  // namespace fathom
