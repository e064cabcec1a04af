#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/progress.h"
#include "measurement/planimetry.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// Volumes of the surfaces through a structure's contours, by what guides the interpolation; empty where there is none.
struct SurfaceVolumes {
  std::optional<double> shape_based_ml;
  std::optional<double> centroid_guided_ml;
  std::optional<double> disc_guided_ml;         ///< linear between each two outlines, as the two above
  std::optional<double> disc_guided_curved_ml;  ///< of second order: reads the outlines beyond as well
};

/// What was measured of one structure.
struct StructureResult {
  std::string name;
  VolumeMeasurement measurement;  ///< with all warnings
  SurfaceVolumes surfaces;
  double seconds = 0.0;  ///< time that the measurement took
};

struct MeasureOptions {
  bool surfaces = true;  ///< also by surfaces, which takes some tenths of a second for each structure
};

/// Measures every structure by every method. `locator` is that of `recording`. Where planimetry has no volume the
/// surfaces have none either; where a surface cannot be made the reason is among the warnings.
/// Throws Error as cross_sections does; Cancelled.
std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Recording& recording,
                                                const FrameLocator& locator, const MeasureOptions& options = {},
                                                const Progress& progress = {});

/// The results as other programs read them: the keys of `fathom measure --json` (docs/file-formats.md). A method
/// without an answer is null.
nlohmann::ordered_json results_json(const std::vector<StructureResult>& results);

}  // namespace fathom
