#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/progress.h"
#include "exam/confidence.h"
#include "exam/scan.h"
#include "exam/surface_volumes.h"
#include "measurement/partition_volume.h"
#include "measurement/planimetry.h"
#include "registration/division.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// What was measured of a structure in one part of space, or in one sweep where nothing divides space.
struct PartResult {
  std::size_t region = 0;
  std::size_t sweep = 0;
  VolumeMeasurement measurement;  ///< its warnings are among the structure's, too
  SurfaceVolumes surfaces;
  /// Estimate of what its sections do not reach before a dividing plane; empty without planes.
  std::optional<double> missing_ml;
  std::string loss;  ///< the same in words; empty where nothing worth saying is missing
};

/// What was measured of one structure.
struct StructureResult {
  std::string name;
  VolumeMeasurement measurement;  ///< with all warnings
  SurfaceVolumes surfaces;
  std::vector<PartResult> partitions;  ///< their sum is `measurement`; empty where the scan was taken as one sweep
  Confidence confidence;               ///< nothing where several sweeps have no dividing planes
  double seconds = 0.0;                ///< time that the measurement took
};

struct MeasureOptions {
  bool surfaces = true;  ///< also by surfaces, which takes some tenths of a second for each structure
  /// Also how far the volumes can be trusted, where the sweeps' volumes have a sum.
  std::optional<ConfidenceOptions> confidence = std::nullopt;
};

/// Measures every structure by every method. `locator` is that of `recording`. Where planimetry has no volume the
/// surfaces have none either; where a surface cannot be made the reason is among the warnings.
/// Throws Error as cross_sections does; Cancelled.
std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Recording& recording,
                                                const FrameLocator& locator, const MeasureOptions& options = {},
                                                const Progress& progress = {});

/// The same of several sweeps, perhaps of several recordings: every structure is measured in each part of space by the
/// sweep that is used there, and these volumes are added. Surfaces are cut by the dividing planes.
/// Throws Error as measure_partitions and measure_sweeps do; Cancelled.
std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Scan& scan,
                                                const Division& division, const MeasureOptions& options = {},
                                                const Progress& progress = {});

/// What planimetry gives of one structure in several sweeps, with the warnings of its outlines: the result without
/// surfaces. `measured` is of the division.
StructureResult division_result(const Structure& structure, const Scan& scan, const Division& division,
                                PartitionedVolume measured);

/// The results as other programs read them: the keys of `fathom measure --json` (docs/file-formats.md). A method
/// without an answer is null.
nlohmann::ordered_json results_json(const std::vector<StructureResult>& results);

}  // namespace fathom
