#pragma once

#include <string>
#include <vector>

namespace fathom {

/// What the user must know of marked frames that were left out because no position is known there: `lost` are their
/// numbers, at least one. Frames lost on the way are made good by their neighbours; nothing stands for those before
/// `first` and beyond `last`, the first and last frames that are used.
std::string lost_frames_warning(std::vector<int> lost, int first, int last);

}  // namespace fathom
