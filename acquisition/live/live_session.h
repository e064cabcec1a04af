#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/live/live_source.h"
#include "acquisition/live/tracked_frame.h"

namespace fathom {

enum class LiveStream { kImages, kTracker };

/// Why a calibration does not hold any more for the images that come.
struct GeometryFault {
  std::string message;   ///< "the images changed from 640x480 to 800x600 pixels"
  double since_s = 0.0;  ///< time stamp of the first frame that may have the other geometry, on live_clock_s()
};

/// A change of a source's state, or something that the user must know.
struct SessionEvent {
  LiveStream stream = LiveStream::kImages;
  std::optional<SourceState> state;            ///< set where the source changed it
  bool warning = false;                        ///< whether frames or poses are lost or not to be trusted
  double time_s = 0.0;                         ///< on live_clock_s()
  std::string message;                         ///< one line that names the source
  std::optional<GeometryFault> geometry = {};  ///< set where from now on no frame's pixels have a place
};

/// Who receives tracked frames: the recorder, the display, the server. All calls come from the session's own thread,
/// one at a time: return soon, never throw, never call the session's add, remove or stop from within.
class SessionListener {
 public:
  virtual ~SessionListener() = default;
  /// In the order of the images' time stamps.
  virtual void on_frame(const SharedFrame& frame) = 0;
  /// Every sample as the tracker delivered it; one whose numbers cannot be used arrives with a status that says so.
  virtual void on_sample(const TrackerSample& /*sample*/) {}
  virtual void on_event(const SessionEvent& /*event*/) {}
};

struct SessionOptions {
  /// A pose between two samples farther apart is not valid: a hand that changes its speed by 1000 mm/s each second
  /// leaves the straight way by 2 mm meanwhile. A tracker at 20 Hz may miss one sample.
  double max_gap_s = 0.12;
  /// How long a frame waits for the tracker sample behind it: the gap, and the line's delay.
  double max_wait_s = 0.3;
  /// What may wait between the sources and the listeners; further frames are dropped, counted and told.
  std::size_t max_waiting_frames = 120;
  std::size_t max_waiting_bytes = 256u << 20;
  /// The transforms without which a frame's place is not known. Empty: those named "Probe..." and "Reference...", all
  /// where there is none of these.
  std::vector<std::string> required_transforms = {};
  /// Looks at every frame before listeners get it, on the session's thread, until it finds a fault (registration's
  /// GeometryWatch does). That frame and all after it get the status "INVALID". Empty: nobody looks.
  std::function<std::optional<GeometryFault>(const LiveFrame&)> watch_geometry = {};

  /// Throws Error, naming the option, when a value is out of range.
  void check() const;
};

/// One transform as the tracker reports it.
struct TransformStatistics {
  std::string transform;
  Pose last;                    ///< the newest sample
  double rate_hz = 0.0;         ///< over the last two seconds
  double age_s = 0.0;           ///< since it was measured
  std::uint64_t samples = 0;    ///< all so far
  std::uint64_t not_valid = 0;  ///< of these
};

/// One source as seen by the session.
struct StreamStatistics {
  std::string source;  ///< its name
  SourceState state = SourceState::kConnecting;
  std::string message;          ///< of its last event
  double rate_hz = 0.0;         ///< frames or samples over the last two seconds
  std::optional<double> age_s;  ///< since the newest one was made; empty before the first
  std::uint64_t received = 0;
  std::uint64_t lost = 0;      ///< before they arrived: gaps in the source's numbers
  std::uint64_t dropped = 0;   ///< here, because listeners were too slow
  std::uint64_t bad_time = 0;  ///< whose stamps cannot be: backwards, in the future, or long past
};

struct SessionStatistics {
  StreamStatistics images;
  StreamStatistics tracker;
  std::vector<TransformStatistics> transforms;
  std::uint64_t frames = 0;          ///< handed to listeners
  std::uint64_t invalid_frames = 0;  ///< of these, not TrackedFrame::valid()
  std::size_t waiting = 0;           ///< frames between source and listeners now
  bool tracked = false;              ///< of the newest frame
  int width = 0;                     ///< of the newest frame, pixels
  int height = 0;
  int pixel_type = 0;
  std::string geometry_fault;        ///< why a calibration does not hold any more; empty while it may
  std::uint64_t format_changes = 0;  ///< how often the images' size or type has changed: a calibration holds for none
};

/// Puts an image source and a tracker source together: frames with the poses at the images' own times.
///
/// A pose is interpolated between the samples before and behind the image's time (straight way, slerp); it is valid
/// only if both are, and they are no farther apart than SessionOptions::max_gap_s. A sample of the image's very time
/// (of the device's stamps, where both come from one source) is taken as it is, bit for bit. A frame waits for the
/// sample behind it, at most max_wait_s. Frames whose time stamps cannot be are passed on as not valid, at the time of
/// their arrival, so that time always increases.
class LiveSession {
 public:
  /// `tracker` may be null: the image source gives the poses too. With two sources each gives its own kind only.
  LiveSession(std::unique_ptr<LiveSource> images, std::unique_ptr<LiveSource> tracker,
              const SessionOptions& options = {});
  /// Stops.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// `listener` must live until it is removed or the session has stopped. Once remove() has returned no call reaches
  /// it. At any time, from any thread but the session's own.
  void add(SessionListener& listener);
  void remove(SessionListener& listener);

  /// Throws Error when a device is not there. Once only.
  void start();
  /// Hands on what still waits, then ends. May be called twice.
  void stop();

  /// Whether no more frames will come: the image source has ended or failed, and all it gave was handed on.
  bool ended() const;

  SessionStatistics statistics() const;
  /// The newest frame that listeners have got; null before the first.
  SharedFrame latest_frame() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace fathom
