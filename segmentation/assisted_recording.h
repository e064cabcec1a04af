#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "segmentation/contours.h"
#include "segmentation/live_wire.h"
#include "segmentation/outline_editing.h"
#include "segmentation/refine.h"
#include "segmentation/region_growing.h"
#include "segmentation/seeds.h"

namespace fathom {

/// Assisted outlining of the frames of one recording of an exam. `recording` is its index; what belongs to others is
/// left out (seeds) or left alone (contours).
///
/// All throw Error naming recording and frame: for seeds as `require_seeds_on_images`, where a tool does not work on a
/// frame, when outlines of a frame cross each other, when there are no images or damaged ones; Cancelled.

/// A closed outline for each entry of seeds, in their order.
std::vector<Contour> outline_by_seeds(const Recording& from, int recording, const std::vector<FrameSeeds>& seeds,
                                      const LiveWireOptions& options, const Progress& progress = {});

/// The regions around all seeds of each frame.
std::vector<Contour> outline_regions(const Recording& from, int recording, const std::vector<FrameSeeds>& seeds,
                                     const RegionOptions& options, const Progress& progress = {});

/// Moves the closed contours of one of the structures to the boundary, not into the others; what the boundary looks
/// like is learnt from all contours of the structure together. Frames whose image is marked as invalid keep theirs.
/// Confidences are dropped: a moved contour is another one.
void refine_structure(const Recording& from, int recording, const RefineOptions& options,
                      std::vector<Structure>& structures, std::size_t which, const Progress& progress = {});

/// How outlines are finished, whichever way they were made.
struct FinishOptions {
  CleanOptions clean;
  double smooth_px = 0.0;  ///< bends shorter than this are evened out; areas stay
  /// Throws Error as `cleaned` and `evened_out`.
  void check() const;
};

/// On every frame that has only closed contours.
void finish(const FinishOptions& options, Structure& structure);

}  // namespace fathom
