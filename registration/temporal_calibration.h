#pragma once

#include <optional>

#include "registration/temporal_signals.h"

namespace fathom {

struct TemporalOptions {
  double max_latency_s = 0.5;    ///< either way: latencies beyond are not looked for
  int min_frames = 30;           ///< of the image that the tracker's poses cover
  double min_correlation = 0.8;  ///< less: the recordings do not show the same motion
  double min_motion_mm = 2.0;    ///< standard deviation of the probe's place along its line
  double min_motion_px = 3.0;    ///< of the floor's depth in the image
  double max_stddev_s = 0.02;    ///< a latency that is known no better is refused

  void check() const;
};

/// How late the tracker's stamps are.
struct TemporalCalibration {
  double latency_s = 0.0;  ///< the pose of a frame stamped t is the tracker's at t + latency_s
  double stddev_s = 0.0;
  double correlation = 0.0;  ///< of the two signals at that latency, its sign dropped
  double px_per_mm = 0.0;    ///< of the floor, for a motion along the line; its sign tells the direction
  double rms_px = 0.0;       ///< distance of the floor from where the tracker expects it
  int frames_used = 0;
  int frames_seen = 0;  ///< that show the floor
};

/// The latency that makes the floor's depth in the image, `image`, a linear function of the probe's place, `tracker`:
/// depth(t) = scale place(t + latency) + offset. The best correlation over the range starts a robust least squares fit;
/// which way the line points is not known, so only the size of the correlation counts. The standard deviation holds for
/// errors that hang together in time. Throws Error when one of them does not move, when they share too little time,
/// when they do not resemble each other, when the motion does not tell (it goes one way only), and when it repeats so
/// that another latency in the range fits nearly as well.
TemporalCalibration find_latency(const Signal& image, const Signal& tracker, const TemporalOptions& options = {});

}  // namespace fathom
