#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/frame_locator.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"
#include "segmentation/stack_refinement.h"

namespace fathom {

/// From this confidence on, contours are expected to be right (Dice at least 0.9) 19 times out of 20.
inline constexpr double kSureContour = 0.9;

struct PropagateOptions {
  std::optional<std::string> structure;  ///< the only one to propagate; empty: all
  int every = 1;                         ///< of the frames between two drawn ones, outline every so many
  bool pixels = true;                    ///< false: by the drawn outlines alone
  bool round_ends = true;                ///< false: towards an end structures taper off as disc-guided surfaces do
  /// Standard deviation of the prediction's error half-way between two drawn sections: as a share of the error that
  /// shows where a drawn section is predicted from its neighbours, twice as far apart; and, where nothing shows or a
  /// part comes or goes, as a share of how far the outline moves from one section to the other.
  double spread_of_misfit = 0.1;
  double spread_of_change = 0.3;
  /// The same half-way to an end, as a share of half the thickness of the part that ends; three times as much where the
  /// end is not touched.
  double spread_of_end = 0.03;
  /// The same where no third drawn section tells how the structure bulges between two, as a share of the way between
  /// them: a ball through two equal circles bulges by up to half of it.
  double spread_of_gap = 0.25;
  StackRefinementOptions refinement;

  /// Throws Error when a value is out of range.
  void check() const;
};

/// What was made of one frame for one structure.
struct PropagatedFrame {
  std::string structure;
  int frame = 0;
  int contours = 0;         ///< 0: the structure is taken not to be there
  double confidence = 0.0;  ///< the probability that Dice is at least 0.9
  /// What the confidence is made of: expected error, disagreement of pixels and prediction, and change from section to
  /// section, all as 1 - Dice.
  double expected_error = 0.0;
  double moved = 0.0;
  double change = 0.0;
};

struct Propagation {
  std::vector<Structure> structures;    ///< as drawn, and the contours between with their confidence
  std::vector<PropagatedFrame> frames;  ///< by structure, frames ascending
  std::vector<std::string> refused;     ///< between which drawn frames nothing was done, and why
  int contours = 0;                     ///< that were added
};

/// Fills the frames between drawn ones: outlines that lead, guided by maximal discs, from the drawn frame before to the
/// one behind are moved to where the pixels show an edge like the drawn ones.
///
/// Drawn contours, extremities and marks of absence are kept as they are; contours with a confidence are results of an
/// earlier propagation and are made anew. Nothing is added before the first and behind the last drawn frame, nor from
/// one of `sweeps` to another; frames without a valid image are left out. Outlines of one frame do not cross, and those
/// of different structures do not overlap, unless the drawn ones do.
///
/// Where `locator` is null, frames are taken as parallel and evenly spaced, and `sweeps` should come from their time
/// stamps. Throws Error when the recording has no images, as frame_marks, when no structure has the name asked for, or
/// when nothing can be filled: the message says why; Cancelled.
Propagation propagate(const Recording& recording, const std::vector<Structure>& structures, const FrameLocator* locator,
                      std::span<const Sweep> sweeps, const PropagateOptions& options, const Progress& progress = {});

}  // namespace fathom
