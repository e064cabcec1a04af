#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"

namespace fathom {

/// Seconds on the one clock of live work: this computer's monotonic clock, which never jumps.
double live_clock_s();

/// One B-scan as a device delivered it.
struct LiveFrame {
  cv::Mat
      image;  ///< MF orientation, types of RecordingHeader; nobody writes to it after delivery, so it is never copied
  std::uint64_t number = 0;             ///< counted by the source from 0; a gap is frames lost before they arrived
  double time_s = 0.0;                  ///< when it was made, on live_clock_s(): the device's stamp, mapped
  double arrival_s = 0.0;               ///< when its last byte had arrived, on live_clock_s()
  std::optional<double> device_time_s;  ///< the device's own stamp, on its own clock
  std::string status;                   ///< as FrameHeader::image_status
  std::vector<std::pair<std::string, std::string>> fields;  ///< what else the device says of it
};

/// One pose as a tracker delivered it.
struct TrackerSample {
  std::string transform;  ///< as RecordingHeader::transforms: "ProbeToTracker"
  Pose pose;              ///< finite and rigid to 1e-3 where valid(); else a status that says why not
  double time_s = 0.0;    ///< when it was measured, on live_clock_s(): the device's stamp, mapped
  double arrival_s = 0.0;
  std::optional<double> device_time_s;
};

enum class SourceState {
  kConnecting,  ///< not there yet, or again not; tries on by itself
  kRunning,
  kEnded,  ///< a recording or clip has been played to its end
  kFailed  ///< will not come back by itself
};

/// A change of a source's state, or something that the user must know ("12 frames lost while the line was cut").
struct SourceEvent {
  SourceState state = SourceState::kConnecting;
  double time_s = 0.0;
  std::string message;  ///< one line that names the device
};

/// Who receives what a source delivers. Called on the source's own thread, one call at a time for each source: return
/// soon, never throw.
class LiveListener {
 public:
  virtual ~LiveListener() = default;
  virtual void on_frame(LiveFrame frame) = 0;
  virtual void on_sample(TrackerSample sample) = 0;
  virtual void on_event(SourceEvent event) = 0;
};

/// A device, a network peer, a recording played back, a simulator: images, poses, or both.
class LiveSource {
 public:
  virtual ~LiveSource() = default;

  /// As the user typed it: "igtl://localhost:18944".
  virtual const std::string& name() const = 0;

  /// Starts delivering to `listener`, which must live until stop() has returned. Throws Error when the device is not
  /// there or not what it should be; a network peer that is not there yet is waited for instead.
  virtual void start(LiveListener& listener) = 0;

  /// Ends delivery; no call reaches the listener after it has returned. May be called twice, and before start().
  virtual void stop() = 0;
};

}  // namespace fathom
