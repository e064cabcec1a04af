#pragma once

#include <string>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "segmentation/contours.h"
#include "segmentation/threshold.h"

namespace fathom {

/// How to outline a whole recording by a threshold.
struct ThresholdRecordingOptions {
  ThresholdOptions threshold;        ///< the same on every frame
  int every = 1;                     ///< outline every so many frames, from the first valid one on
  bool ends = false;                 ///< outline also the first and the last frame that show the structure
  std::string structure = "object";  ///< name of what is outlined

  /// Throws Error when a value is out of range.
  void check() const;
};

/// The structure that a threshold finds in every n-th frame of a recording. Frames whose image is marked as invalid
/// are left out. Throws Error when the recording is coloured, has no images or damaged ones; Cancelled.
Structure segment_by_threshold(const Recording& recording, const ThresholdRecordingOptions& options,
                               const Progress& progress = {});

/// Number of different frames that carry a contour of the structure.
int outlined_frames(const Structure& structure);

}  // namespace fathom
