#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "acquisition/recording.h"
#include "registration/frame_locator.h"
#include "registration/sweep.h"

namespace fathom {

struct FindSweepsOptions {
  /// A longer time between two frames separates sweeps: within a breath hold the hand moves on, after a pause the organ
  /// has moved. Half a second is several frames of the slowest scanners.
  double pause_s = 0.5;
  /// A farther way of the followed pixel from one frame to the next separates sweeps: a hand that sweeps at 100 mm/s
  /// moves 10 mm between frames at 10 a second.
  double jump_mm = 20.0;
  /// The followed pixel; empty: the image's middle. Without a calibration nobody knows where that is, and a turn of the
  /// probe would move it by any distance: then follow the probe's own origin, the pixel (0, 0) of the default
  /// Calibration.
  std::optional<Eigen::Vector2d> follow_px;
  /// As many frames in a row without a pose do not separate: trackers lose a frame or two when a hand passes by. A
  /// frame whose image is marked invalid always separates.
  int lost_poses = 2;
  int min_frames = 1;  ///< shorter runs are no sweeps

  /// Throws Error, naming the option, when a value is out of range.
  void check() const;
};

/// The sweeps of a recording, in order. None where no frame is valid. Where the recorder was told of a new sweep, one
/// begins. `locator` is that of `recording`.
std::vector<Sweep> find_sweeps(const Recording& recording, const FrameLocator& locator,
                               const FindSweepsOptions& options = {});

/// Splits sweep `index` before `frame`, joins it with the one after it, or drops it. Each throws Error when there is no
/// such sweep, `frame` is not inside of it, or the next one belongs to another recording.
void split_sweep(std::vector<Sweep>& sweeps, std::size_t index, int frame);
void join_sweeps(std::vector<Sweep>& sweeps, std::size_t index);
void drop_sweep(std::vector<Sweep>& sweeps, std::size_t index);

}  // namespace fathom
