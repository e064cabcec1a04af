#pragma once

#include <vector>

#include "sim/studies/study.h"
#include "sim/studies/sweeps_study.h"

namespace fathom {

/// Study 4.1: several sweeps, every cell of Treece 2000, table 4.1. A case is a cell: an object in a pattern, scanned
/// with every number of frames within the limits.
const Study& sweeps_table();

StudyReport sweeps_report(const std::vector<SweepsCell>& cells);

}  // namespace fathom
