#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"
#include "segmentation/contours.h"

namespace fathom {

/// How many frames a contact sheet shows, and how large.
struct ContactSheetOptions {
  int columns = 4;
  int most_frames = 16;   ///< of more, so many are shown, spread evenly from the first to the last
  int pane_px = 300;      ///< longer side of a frame
  int recording = 0;      ///< index in the exam: contours of others are not shown
  bool crop = true;       ///< show the part of the image around all contours only, the same on every frame
  std::vector<int> also;  ///< frames to show although they have no contours

  /// Throws Error when a value is out of range.
  void check() const;
};

/// The frames that are outlined with their contours, in rows. Below each its number, and the lowest confidence of its
/// contours where it is known. 8-bit BGR. Throws Error when there is no frame to show, or a contour stands on a frame
/// that the recording does not have.
cv::Mat contact_sheet(const Recording& recording, const std::vector<Structure>& structures,
                      const ContactSheetOptions& options = {});

}  // namespace fathom
