#pragma once

#include <vector>

#include "registration/partition.h"
#include "registration/sweep.h"

namespace fathom {

/// How the sweeps of a scan share space.
struct Division {
  std::vector<Sweep> sweeps;
  SpacePartition partition;  ///< of these sweeps, in their order; without planes every sweep is used by itself
};

}  // namespace fathom
