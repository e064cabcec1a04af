#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "measurement/planimetry.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// What was measured of one structure.
struct StructureResult {
  std::string name;
  VolumeMeasurement measurement;
  double seconds = 0.0;  ///< time that the measurement took
};

/// Measures every structure by every method. `locator` is that of `recording`. Throws Error as cross_sections does.
std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Recording& recording,
                                                const FrameLocator& locator);

/// The results as other programs read them: the keys of `fathom measure --json` (docs/file-formats.md). A method
/// without an answer is null.
nlohmann::ordered_json results_json(const std::vector<StructureResult>& results);

}  // namespace fathom
