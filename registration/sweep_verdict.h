#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/live/live_source.h"
#include "acquisition/recording.h"
#include "registration/calibration.h"
#include "registration/pose_chain.h"
#include "registration/tracker_jitter.h"

namespace fathom {

struct VerdictOptions {
  /// A longer time between two frames of a sweep is a gap; empty: two and a half times the usual one.
  std::optional<double> max_interval_s = {};
  /// A longer way of any of the image's corners from one frame to the next is too fast: what lies between is not seen.
  /// B-scans are two to four millimetres thick.
  double max_step_mm = 2.0;
  /// More than that while the probe is held still is too much: of the tracker, or of metal beside it.
  double max_jitter_mm = 0.5;
  double max_jitter_deg = 0.5;
  /// What the sweep shall pass on both sides, in reference coordinates; empty: not known.
  std::optional<Eigen::AlignedBox3d> region_mm = {};

  /// Throws Error, naming the option, when a value is out of range.
  void check() const;
};

/// Whether a sweep can be used, said right after it was recorded, while it can be made again.
struct SweepVerdict {
  int frames = 0;
  int valid_frames = 0;  ///< image and place of the probe
  int gaps = 0;          ///< between frames of one sweep
  double longest_gap_s = 0.0;
  int dropouts = 0;  ///< runs of frames that are not valid
  double longest_dropout_s = 0.0;
  int too_fast = 0;                       ///< steps longer than max_step_mm
  std::optional<double> largest_step_mm;  ///< empty where there are no two valid frames in a row
  std::optional<double> speed_mm_s;       ///< median over the steps; empty without time stamps
  std::optional<TrackerJitter> jitter;    ///< empty where the probe was never held still for half a second
  std::optional<bool> passes_start;       ///< of the region, at the side where the sweep begins; empty: not known
  std::optional<bool> passes_end;         ///< and at the other
  std::vector<std::string> warnings;      ///< one line each; none: the sweep is good

  bool good() const { return warnings.empty(); }
};

/// `calibration` may be null: steps are then those of the probe's origin, and nobody knows of the region. Where it was
/// made for images of another size it is not used, with a warning. `samples` are the probe's raw ones; where there are
/// none the jitter is that of the frames' poses. Throws Error where a pose is not rigid.
SweepVerdict judge_sweep(const Recording& recording, const Calibration* calibration, const FrameNames& names,
                         std::span<const TrackerSample> samples, const VerdictOptions& options = {});

}  // namespace fathom
