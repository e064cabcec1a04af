#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// What a structure has on one frame: outlines, or the point of an extremity, or the mark that it is not there.
struct FrameMarks {
  int frame = 0;
  std::vector<const Polygon*> outlines;  ///< of the structure; combined by even-odd they enclose a definite area
  const Eigen::Vector2d* extremity_px = nullptr;
  bool absent = false;
};

/// The marks of every frame that has any, frames ascending. They point into `structure`.
///
/// Throws Error, naming recording, structure and frame, when a contour stands on a frame that the recording does not
/// have or on another recording of an exam, crosses itself or another one of its frame, or is open, and when a frame
/// has marks that exclude each other.
std::vector<FrameMarks> frame_marks(const Structure& structure, const FrameLocator& locator);

/// The same where no poses are needed: `recording` is named in messages.
std::vector<FrameMarks> frame_marks(const Structure& structure, const std::string& recording, int frame_count);

}  // namespace fathom
