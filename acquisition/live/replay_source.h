#pragma once

#include <memory>

#include "acquisition/live/source_registry.h"

namespace fathom {

/// How a recording is played.
struct ReplayOptions {
  double speed = 1.0;  ///< 2: twice as fast as it was recorded; kMinSpeed to kMaxSpeed
  bool loop = false;   ///< begins again at its end, until stopped

  static constexpr double kMinSpeed = 1e-3;
  static constexpr double kMaxSpeed = 1e3;

  /// Throws Error when the speed is out of range.
  void check() const;
};

/// Plays a recording as if it were being made: frames and poses come in the recording's own time, divided by the speed,
/// on live_clock_s(); `device_time_s` is the stored stamp. All that a reader keeps of a frame is delivered: status,
/// fields, and each pose that it has as a sample with the frame's time, just before the frame, valid or not. A pose
/// that starts at the image and scales, which no tracker measures, is left out and said in an event. Frames without a
/// stamp come between those that have one; a recording without any is played at kRateWithoutStamps, and says so.
/// No frame is skipped when the computer is too slow: `arrival_s` then tells. Ends with kEnded.
std::unique_ptr<LiveSource> make_replay(std::string name, std::unique_ptr<Recording> recording,
                                        const ReplayOptions& options = {});

inline constexpr double kRateWithoutStamps_hz = 25.0;

/// Adds "replay:FILE[?speed=1][&loop=1]"; the file is opened by start(), which throws Error as open_recording.
void add_replay_sources(SourceRegistry& registry);

}  // namespace fathom
