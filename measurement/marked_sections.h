#pragma once

#include <span>
#include <string>
#include <vector>

#include "measurement/cross_section.h"
#include "measurement/frame_marks.h"
#include "registration/frame_locator.h"

namespace fathom {

/// `cross_sections` of the structure that `marks`, from frame_marks, are of: for who needs the marks as well, which
/// take longest to check.
std::vector<CrossSection> cross_sections(std::span<const FrameMarks> marks, const FrameLocator& locator,
                                         std::vector<std::string>* warnings);

}  // namespace fathom
