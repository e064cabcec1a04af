#pragma once

#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "measurement/missing_ends.h"
#include "measurement/volume_interval.h"
#include "measurement/where_next.h"
#include "registration/calibration.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// How far the volume of a structure can be trusted, and what would make it better.
struct Confidence {
  std::optional<VolumeInterval> interval;  ///< about quadric planimetry
  std::optional<NextOutline> next;
  std::vector<MissingEnd> missing_ends;
};

/// What the interval is made from.
struct ConfidenceOptions {
  Calibration calibration;  ///< the locator's
  FrameNames names;         ///< the locator's
  MeasurementErrors errors;
};

/// `sections` are those of `structure`. Nothing is known of a structure without a volume. Throws Error as
/// calibration_spread_ml; Cancelled.
Confidence confidence(const Structure& structure, std::span<const CrossSection> sections, const Recording& recording,
                      const FrameLocator& locator, const ConfidenceOptions& options, const Progress& progress = {});

/// The frame to outline next, where that would make the volume surer by so much that it is worth a stroke.
std::optional<NextOutline> next_worth_outlining(const Confidence& confidence);

/// Adds the keys `volume_interval_ml`, `volume_interval_parts_ml`, `where_next` and `missing_ends`
/// (docs/file-formats.md).
void add_confidence(const Confidence& confidence, nlohmann::ordered_json& item);

}  // namespace fathom
