#pragma once

#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "registration/frame_locator.h"
#include "registration/partition.h"

namespace fathom {

/// The sweeps of a recording and the planes between them.
struct Division {
  std::vector<Sweep> sweeps;
  SpacePartition partition;
};

/// Reads what `fathom planes --out` writes; where the file names no sweeps they are found. Throws Error when the file
/// is damaged, names frames that the recording does not have or another recording of an exam, or the recording has no
/// images or no sweep.
Division read_division(const std::string& planes_file, const Recording& recording, const FrameLocator& locator);

}  // namespace fathom
