#pragma once

#include <vector>

#include "sim/studies/planimetry_study.h"
#include "sim/studies/study.h"

namespace fathom {

/// Study 2.1: volume against the number of planes, every row and column of Treece 2000, table 2.1, and figures 2.9 to
/// 2.12. A case is one scan: a row with 4 to 20 planes.
const Study& volume_study();

/// A row of the table, measured.
struct VolumeRow {
  PlanimetryRow printed;
  std::vector<MethodAccuracy> methods;  ///< in the order of kVolumeMethods
};

StudyReport volume_report(const std::vector<VolumeRow>& rows);

}  // namespace fathom
