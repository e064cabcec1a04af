#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.h"
#include "measurement/propagate.h"

namespace fathom {

/// Propagation on simulated speckled sweeps of the scenes: true contours on every `drawn_every`-th frame.
struct PropagationStudyOptions {
  int first_sweep = 0;  ///< of those; a study may be made in parts
  int sweeps = 40;      ///< all five scenes in turn, each in all five patterns of one sweep in turn
  int frames = 97;      ///< of each sweep
  int drawn_every = 8;
  std::uint64_t first_seed = 9001;  ///< of the first sweep; the others follow
  double jitter_mm = 0.0;           ///< of the hand
  double jitter_deg = 0.0;
  PropagateOptions propagate;
};

/// A filled frame of one structure against its true outlines; Dice by counted pixels.
struct PropagatedScore {
  PropagatedFrame frame;
  double dice = 0.0;
  double image_free_dice = 0.0;  ///< of disc-guided interpolation of the same contours
};

struct PropagationStudySweep {
  std::string object;
  std::string pattern;
  std::uint64_t seed = 0;
  std::vector<PropagatedScore> scores;        ///< of frames that show the structure, or were filled
  double dice = 0.0;                          ///< mean
  double image_free_dice = 0.0;               ///< mean
  std::vector<double> volume_errors_percent;  ///< of each structure, by cubic planimetry of drawn and filled contours
  double seconds_per_frame = 0.0;
};

std::vector<PropagationStudySweep> propagation_study(const PropagationStudyOptions& options,
                                                     const Progress& progress = {});

/// What is made of all sweeps.
struct PropagationSummary {
  int contours = 0;
  double mean_dice = 0.0;         ///< over frames
  double fifth_percentile = 0.0;  ///< over frames
  double image_free_mean_dice = 0.0;
  double image_free_fifth_percentile = 0.0;
  double fifth_percentile_of_sweeps = 0.0;
  double worst_sweep_dice = 0.0;
  double mean_volume_error_percent = 0.0;  ///< without sign
  double largest_volume_error_percent = 0.0;
  int sure = 0;                      ///< frames of confidence >= 0.9
  double right_of_sure = 0.0;        ///< share of them with Dice >= 0.9
  double right = 0.0;                ///< the same of all
  int hard_sweeps = 0;               ///< where image-free interpolation scores <= 0.92
  double largest_fault_ratio = 0.0;  ///< on them, of 1 - Dice against that of image-free interpolation
  double mean_fault_ratio = 0.0;
  double seconds_per_frame = 0.0;
};

PropagationSummary summary_of(const std::vector<PropagationStudySweep>& sweeps);

}  // namespace fathom
