#pragma once

#include "sim/studies/study.h"

namespace fathom {

/// Study 2.13: the hand is unsteady, planes are displaced before the scan; study 2.14: recorded positions are wrong,
/// planes are displaced after it. Ten planes of the glove, displaced uniformly in +- on all three axes and angles at
/// five scales. Treece 2000, section 2.3.3. Case 0 is the scan without disturbance; then come the samples of the first
/// scale, and so on.
const Study& unsteady_study();
const Study& misregistration_study();

}  // namespace fathom
