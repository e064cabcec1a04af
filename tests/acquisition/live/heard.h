#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <vector>

#include "acquisition/live/live_source.h"

namespace fathom {

/// Keeps all that a source delivers.
class Heard : public LiveListener {
 public:
  void on_frame(LiveFrame frame) override;
  void on_sample(TrackerSample sample) override;
  void on_event(SourceEvent event) override;

  /// Waits until `done` holds, at most `longest_s`. Returns whether it does; called with what came so far.
  bool wait_for(const std::function<bool(const Heard&)>& done, double longest_s = 20.0);
  /// Waits for a frame count, or for an event of this state.
  bool wait_for_frames(std::size_t count, double longest_s = 20.0);
  bool wait_for_state(SourceState state, double longest_s = 20.0);

  /// Whether an event holds `text`.
  bool was_told(const std::string& text) const;

  // To be read in wait_for(), or after the source has stopped.
  std::vector<LiveFrame> frames;
  std::vector<TrackerSample> samples;
  std::vector<SourceEvent> events;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace fathom
