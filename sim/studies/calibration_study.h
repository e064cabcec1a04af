#pragma once

#include "sim/studies/study.h"

namespace fathom {

/// Study `calibration`: how far off a probe's calibration is, and whether it says so. Wires (registered, and where
/// their place is estimated too), a floor and a point, with tracker noise of 0, 0.25 and 0.5 mm. A case is a target
/// with one noise, its samples scans of 10 s, a pixel drawn about the true points; or, a tenth as many, found in
/// speckled images.
const Study& calibration_study();

}  // namespace fathom
