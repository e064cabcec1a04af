#pragma once

#include <vector>

#include <Eigen/Core>

#include "registration/probe_poses.h"

namespace fathom {

struct StillOptions {
  double min_duration_s = 0.8;  ///< the tip rests for at least so long
  double window_s = 0.2;        ///< over which its speed is taken
  double same_place_mm = 3.0;   ///< periods whose places are nearer than this are one place, touched again
  double max_sd_mm = 2.0;       ///< of single positions: a tip that moves about more does not rest

  void check() const;
};

/// A place where the tip rested.
struct StillPeriod {
  int first_frame = 0;
  int last_frame = 0;                                  ///< inclusive
  Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  ///< mean, in reference coordinates
  Eigen::Vector3d sd_mm = Eigen::Vector3d::Zero();     ///< of the mean; what follows each other counts as alike
  int poses = 0;
};

/// The places that the tip of `tool` was held still at, one after the other. A tip is still below the speed that
/// divides the recording's speeds best into slow and fast ones (Otsu 1979, of their logarithms), so neither the
/// tracker's noise nor the hand's speed need be known. Throws Error when the recording has no time stamps, and when the
/// tip never rests or never moves.
std::vector<StillPeriod> still_periods(const ProbePoses& tool, const Eigen::Vector3d& tip_in_tool_mm,
                                       const StillOptions& options = {});

}  // namespace fathom
