#pragma once

#include <string>
#include <vector>

namespace fathom {

/// Frames for a message, in any order: "frame 3", "frames 3, 7 to 9 and 12", "frames 1, 3, ... and 27 more".
std::string frame_list(std::vector<int> frames);

}  // namespace fathom
