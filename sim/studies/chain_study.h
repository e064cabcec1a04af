#pragma once

#include "sim/studies/study.h"

namespace fathom {

/// Study `chain`: the whole system, from a simulated tracker and probe through calibration by images of a phantom to
/// the volume of organs, with an error budget: how much each link contributes alone, and all of them together. A case
/// is a system: one calibration, and every organ measured with it.
const Study& chain_study();

}  // namespace fathom
