#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "acquisition/live/fault_run.h"
#include "acquisition/live/frame_matcher.h"
#include "acquisition/live/live_session.h"
#include "acquisition/live/session_counters.h"

namespace fathom {

/// The session itself: what sources deliver goes into a queue, and a thread takes it from there to the listeners.
class LiveSession::Worker {
 public:
  Worker(std::unique_ptr<LiveSource> images, std::unique_ptr<LiveSource> tracker, const SessionOptions& options)
      : options_(options),
        images_(std::move(images)),
        tracker_(std::move(tracker)),
        counters_(images_->name(), tracker_ ? tracker_->name() : images_->name()),
        matcher_(options, tracker_ == nullptr) {
    options.check();
  }

  void start();
  void stop();
  void add(SessionListener& listener);
  void remove(SessionListener& listener);
  bool ended() const;
  SessionStatistics statistics() const;
  SharedFrame latest_frame() const;

 private:
  struct StreamEvent {
    LiveStream stream;
    SourceEvent event;
  };
  using Item = std::variant<LiveFrame, TrackerSample, StreamEvent>;

  // What a source calls, on its own thread.
  class Inbox : public LiveListener {
   public:
    Inbox(Worker& worker, LiveStream stream) : worker_(worker), stream_(stream) {}
    void on_frame(LiveFrame frame) override {
      if (stream_ == LiveStream::kImages) worker_.receive(std::move(frame));
    }
    void on_sample(TrackerSample sample) override {
      if (stream_ == LiveStream::kTracker || !worker_.tracker_) worker_.receive(std::move(sample));
    }
    void on_event(SourceEvent event) override { worker_.receive(StreamEvent{stream_, std::move(event)}); }

   private:
    Worker& worker_;
    LiveStream stream_;
  };

  void receive(LiveFrame frame);
  void receive(TrackerSample sample);
  void receive(StreamEvent event);

  void run();
  void handle(LiveFrame frame);
  void handle(TrackerSample sample);
  void handle(StreamEvent event);
  void deliver(SharedFrame frame);
  SharedFrame watched(const SharedFrame& frame);
  void say_tracking(const TrackedFrame& frame);
  void say_dropped();
  void say(LiveStream stream, bool warning, const std::string& message, std::optional<GeometryFault> geometry = {});
  const std::string& source_of(LiveStream stream) const {
    return stream == LiveStream::kTracker && tracker_ ? tracker_->name() : images_->name();
  }

  const SessionOptions options_;
  const std::unique_ptr<LiveSource> images_;
  const std::unique_ptr<LiveSource> tracker_;
  Inbox image_inbox_{*this, LiveStream::kImages};
  Inbox tracker_inbox_{*this, LiveStream::kTracker};
  std::thread thread_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::deque<Item> queue_;
  bool stopping_ = false;
  std::size_t waiting_frames_ = 0;  // in the queue and in the matcher
  std::size_t waiting_bytes_ = 0;
  SessionCounters counters_;
  SharedFrame latest_;

  std::mutex listeners_mutex_;  // held while they are called
  std::vector<SessionListener*> listeners_;

  // Of the worker's thread alone.
  FrameMatcher matcher_;
  bool geometry_changed_ = false;
  FaultRun lost_;
  FaultRun bad_image_times_;
  FaultRun bad_sample_times_;
  FaultRun bad_poses_;
  FaultRun full_;
  std::uint64_t dropped_told_ = 0;
};

}  // namespace fathom
