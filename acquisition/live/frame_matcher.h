#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/live/live_session.h"
#include "acquisition/live/pose_interpolator.h"

namespace fathom {

/// Whether time stamps can be believed: finite, later than the one before, not in the future of their arrival, not long
/// before it.
class StampCheck {
 public:
  bool accepts(double time_s, double arrival_s);

 private:
  std::optional<double> last_s_;
};

/// Gives frames their poses, as LiveSession says; of one thread, and with the time handed in.
class FrameMatcher {
 public:
  /// `one_source`: images and poses have stamps of one device.
  FrameMatcher(const SessionOptions& options, bool one_source) : options_(options), one_source_(one_source) {}

  /// Takes a sample; where its numbers cannot be used it gets a status that says so. Returns false where its time
  /// stamp cannot be used either: frames are not told of it.
  bool add(TrackerSample& sample);

  /// Takes a frame. Returns false where its time stamp cannot be: it is passed on at its arrival, not valid.
  bool add(LiveFrame frame);

  /// The next frame whose poses are known, or which has waited long enough; null where none is ready at `now_s`.
  SharedFrame next(double now_s);

  /// When the first waiting frame will be ready at the latest; empty where none waits.
  std::optional<double> deadline_s() const;

  /// From now on frames wait for no sample, or do again.
  void expect_samples(bool expected) { expected_ = expected; }

  std::size_t waiting() const { return frames_.size(); }

 private:
  struct Transform {
    std::string name;
    PoseInterpolator poses;
    StampCheck stamps;
    double arrival_s = 0.0;  ///< of the newest sample
  };

  /// Null where there are too many already.
  Transform* transform(const std::string& name);
  PoseMoment moment_of(const LiveFrame& frame) const;
  bool is_ready(const LiveFrame& frame, double now_s) const;
  bool is_required(const std::string& transform) const;
  void give_poses(TrackedFrame& tracked) const;

  struct Waiting {
    LiveFrame frame;
    bool time_is_known = true;
  };

  SessionOptions options_;
  bool one_source_;
  bool expected_ = true;
  std::deque<Waiting> frames_;
  std::vector<Transform> transforms_;
  StampCheck stamps_;
  double last_time_s_ = 0.0;  ///< of the newest frame, as passed on
};

}  // namespace fathom
