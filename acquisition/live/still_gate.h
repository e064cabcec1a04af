#pragma once

#include <deque>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "acquisition/live/tracked_frame.h"

namespace fathom {

/// Where the probe is in a frame: in the reference, where the tracker follows one ("ReferenceToTracker"), else in the
/// tracker. Made of "ProbeTo..." or, where there is none, of the first transform. Empty where that is not valid.
std::optional<Eigen::Isometry3d> probe_pose(const TrackedFrame& frame);

struct HoldStillOptions {
  double duration_s = 0.7;  ///< the probe is still once it has been held so long
  double radius_mm = 1.5;   ///< within which its origin stays meanwhile: a hand trembles by less than a millimetre
  double angle_deg = 2.0;   ///< within which it turns meanwhile

  /// Throws Error, naming the option, when a value is out of range.
  void check() const;
};

/// Tells whether the probe is held still.
class StillDetector {
 public:
  explicit StillDetector(const HoldStillOptions& options) : options_(options) {}

  /// Takes the pose at a time, later than those before; a lost pose begins again. Returns whether the probe has stayed
  /// within radius_mm and angle_deg of where it is now for duration_s.
  bool add(double time_s, const std::optional<Eigen::Isometry3d>& pose);

 private:
  struct At {
    double time_s;
    Eigen::Isometry3d pose;
  };

  HoldStillOptions options_;
  std::deque<At> poses_;
};

enum class GateState {
  kWaitingForStill,  ///< hold the probe still where the sweep shall begin
  kReady,            ///< recording; the probe has not left yet
  kSweeping,         ///< recording; hold still to end
  kClosed            ///< the sweep has ended
};

/// Opens when the probe has been held still, and closes when it has moved and is still again.
class StillGate {
 public:
  explicit StillGate(const HoldStillOptions& options) : detector_(options), options_(options) {}

  /// Takes the next frame; returns the state with it.
  GateState add(const TrackedFrame& frame);
  GateState state() const { return state_; }
  /// Waits for the next sweep: the probe must move, and be held still again.
  void open_again();

 private:
  StillDetector detector_;
  HoldStillOptions options_;
  GateState state_ = GateState::kWaitingForStill;
  bool was_still_ = false;  ///< where the sweep before ended, and not moved since
  std::optional<Eigen::Isometry3d> start_;
};

}  // namespace fathom
