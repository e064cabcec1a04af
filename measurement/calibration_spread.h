#pragma once

#include <functional>
#include <optional>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/calibration.h"
#include "registration/pose_chain.h"
#include "segmentation/contours.h"

namespace fathom {

/// The standard deviation, in millilitres, that the covariance of the calibration brings into quadric planimetry of a
/// structure: the volume is measured again with every fitted parameter a little off, one after another. Empty where
/// the calibration has no covariance or the structure has no volume. Parameters other than the image's pose, scales,
/// skew and latency are passed over. Throws Error as FrameLocator and cross_sections; Cancelled.
std::optional<double> calibration_spread_ml(const Structure& structure, const Recording& recording,
                                            const Calibration& calibration, const FrameNames& names,
                                            const Progress& progress = {});

/// The same of anything measured with a calibration: `volume_ml` is asked for it with other ones.
std::optional<double> calibration_spread_ml(const Calibration& calibration,
                                            const std::function<std::optional<double>(const Calibration&)>& volume_ml,
                                            const Progress& progress = {});

}  // namespace fathom
