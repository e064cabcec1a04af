#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/live/live_session.h"
#include "acquisition/live/rate_meter.h"

namespace fathom {

/// Counts what a session gets and gives; one call at a time.
class SessionCounters {
 public:
  SessionCounters(const std::string& images, const std::string& tracker);

  void received(const LiveFrame& frame);
  void received(const TrackerSample& sample);
  void dropped(LiveStream stream) { ++of(stream).dropped; }

  /// Returns whether a frame's size or type differs from that of the one before.
  bool changes_format(const cv::Mat& image);
  void changed_geometry(const std::string& fault) { stats_.geometry_fault = fault; }
  void had_bad_time(LiveStream stream) { ++of(stream).bad_time; }
  void checked(const TrackerSample& sample);
  void delivered(const TrackedFrame& frame);
  void changed_state(LiveStream stream, const SourceEvent& event);

  /// Whether the source has ever sent anything.
  bool has_received(LiveStream stream) { return of(stream).received > 0; }
  /// Whether no more images will come.
  bool images_ended() const;
  std::uint64_t dropped_frames() const { return stats_.images.dropped; }

  /// Rates and ages as of now; `waiting` is the caller's.
  SessionStatistics now() const;

 private:
  StreamStatistics& of(LiveStream stream) { return stream == LiveStream::kImages ? stats_.images : stats_.tracker; }

  /// One of SessionStatistics::transforms.
  struct Transform {
    RateMeter rate;
    double newest_s = 0.0;
  };

  SessionStatistics stats_;
  RateMeter image_rate_;
  RateMeter sample_rate_;
  std::vector<Transform> transforms_;
  std::optional<double> newest_image_s_;
  std::optional<double> newest_sample_s_;
  std::optional<std::uint64_t> last_number_;
};

}  // namespace fathom
