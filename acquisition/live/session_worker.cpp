#include "acquisition/live/session_worker.h"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kMostItems = 100000;  // samples and events in the queue: seconds of any tracker

std::size_t bytes_of(const cv::Mat& image) { return image.total() * image.elemSize(); }

}  // namespace

void LiveSession::Worker::start() {
  assert(!thread_.joinable() && !stopping_);
  thread_ = std::thread([this] { run(); });
  try {
    // The tracker first: the first frame shall have a sample before it.
    if (tracker_) tracker_->start(tracker_inbox_);
    images_->start(image_inbox_);
  } catch (...) {
    stop();
    throw;
  }
}

void LiveSession::Worker::stop() {
  images_->stop();
  if (tracker_) tracker_->stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void LiveSession::Worker::add(SessionListener& listener) {
  const std::lock_guard lock(listeners_mutex_);
  listeners_.push_back(&listener);
}

void LiveSession::Worker::remove(SessionListener& listener) {
  const std::lock_guard lock(listeners_mutex_);
  std::erase(listeners_, &listener);
}

void LiveSession::Worker::receive(LiveFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    counters_.received(frame);
    const std::size_t bytes = bytes_of(frame.image);
    const bool full = waiting_frames_ >= options_.max_waiting_frames ||
                      (waiting_frames_ > 0 && waiting_bytes_ + bytes > options_.max_waiting_bytes);
    if (full) {
      counters_.dropped(LiveStream::kImages);
    } else {
      ++waiting_frames_;
      waiting_bytes_ += bytes;
      queue_.push_back(std::move(frame));
    }
  }
  wake_.notify_one();
}

void LiveSession::Worker::receive(TrackerSample sample) {
  {
    const std::lock_guard lock(mutex_);
    counters_.received(sample);
    if (queue_.size() >= kMostItems) {
      counters_.dropped(LiveStream::kTracker);
    } else {
      queue_.push_back(std::move(sample));
    }
  }
  wake_.notify_one();
}

void LiveSession::Worker::receive(StreamEvent event) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(event));
  }
  wake_.notify_one();
}

void LiveSession::Worker::run() {
  std::deque<Item> items;
  bool last = false;
  while (!last) {
    {
      std::unique_lock lock(mutex_);
      const auto awake = [this] { return stopping_ || !queue_.empty(); };
      if (const auto deadline = matcher_.deadline_s()) {
        wake_.wait_for(lock, std::chrono::duration<double>(std::max(0.0, *deadline - live_clock_s())), awake);
      } else {
        wake_.wait(lock, awake);
      }
      items.swap(queue_);
      last = stopping_;
    }
    for (Item& item : items) {
      std::visit([this](auto& value) { handle(std::move(value)); }, item);
      while (const SharedFrame frame = matcher_.next(live_clock_s())) deliver(frame);
    }
    items.clear();
    if (last) matcher_.expect_samples(false);
    while (const SharedFrame frame = matcher_.next(live_clock_s())) deliver(frame);
    say_dropped();
  }
}

void LiveSession::Worker::handle(LiveFrame frame) {
  const double now_s = frame.arrival_s;
  bool changed = false;
  {
    const std::lock_guard lock(mutex_);
    changed = counters_.changes_format(frame.image);
  }
  if (changed) {
    say(LiveStream::kImages, true,
        "its images are now " + std::to_string(frame.image.cols) + " x " + std::to_string(frame.image.rows) +
            " pixels; a calibration made for the former ones does not hold");
  }
  if (!matcher_.add(std::move(frame))) {
    {
      const std::lock_guard lock(mutex_);
      counters_.had_bad_time(LiveStream::kImages);
    }
    if (bad_image_times_.fault(now_s)) {
      say(LiveStream::kImages, true, "its clock has jumped; frames are not valid until it runs on");
    }
  } else if (const auto count = bad_image_times_.fine(now_s)) {
    say(LiveStream::kImages, false, "its clock runs on; " + std::to_string(*count) + " frames are not valid");
  }
}

void LiveSession::Worker::handle(TrackerSample sample) {
  const bool was_valid = sample.pose.valid();
  const bool in_time = matcher_.add(sample);
  if (was_valid && !sample.pose.valid()) {
    if (bad_poses_.fault(sample.arrival_s)) {
      say(LiveStream::kTracker, true,
          printable(sample.transform) + " is not a rotation and a shift of finite numbers; it is not used");
    }
  } else if (const auto count = bad_poses_.fine(sample.arrival_s)) {
    say(LiveStream::kTracker, false, "gives proper poses again; " + std::to_string(*count) + " were not used");
  }
  if (!in_time) {
    if (bad_sample_times_.fault(sample.arrival_s)) {
      say(LiveStream::kTracker, true, "its time stamps do not go on; poses are not used until they do");
    }
  } else if (const auto count = bad_sample_times_.fine(sample.arrival_s)) {
    say(LiveStream::kTracker, false, "its time stamps go on; " + std::to_string(*count) + " poses were not used");
  }
  {
    const std::lock_guard lock(mutex_);
    if (!in_time) counters_.had_bad_time(LiveStream::kTracker);
    counters_.checked(sample);
  }
  const std::lock_guard lock(listeners_mutex_);
  for (SessionListener* listener : listeners_) listener->on_sample(sample);
}

void LiveSession::Worker::handle(StreamEvent event) {
  bool was_there = false;
  {
    const std::lock_guard lock(mutex_);
    was_there = counters_.has_received(event.stream);
    counters_.changed_state(event.stream, event.event);
    if (!tracker_) counters_.changed_state(LiveStream::kTracker, event.event);
  }
  if (event.stream == LiveStream::kTracker || !tracker_) {
    matcher_.expect_samples(event.event.state == SourceState::kConnecting ||
                            event.event.state == SourceState::kRunning);
  }
  // Waiting for a peer that was never there yet is no fault.
  const bool bad =
      event.event.state == SourceState::kFailed || (event.event.state == SourceState::kConnecting && was_there);
  const std::lock_guard lock(listeners_mutex_);
  const SessionEvent told{event.stream, event.event.state, bad, event.event.time_s, event.event.message, {}};
  for (SessionListener* listener : listeners_) listener->on_event(told);
}

void LiveSession::Worker::deliver(SharedFrame frame) {
  frame = watched(frame);
  say_tracking(*frame);
  {
    const std::lock_guard lock(listeners_mutex_);
    for (SessionListener* listener : listeners_) listener->on_frame(frame);
  }
  const std::lock_guard lock(mutex_);
  counters_.delivered(*frame);
  --waiting_frames_;
  waiting_bytes_ -= bytes_of(frame->frame.image);
  latest_ = frame;
}

// The frame, not valid once its pixels have no place any more; the pixels themselves are shared.
SharedFrame LiveSession::Worker::watched(const SharedFrame& frame) {
  if (!geometry_changed_ && options_.watch_geometry) {
    if (const auto fault = options_.watch_geometry(frame->frame)) {
      geometry_changed_ = true;
      {
        const std::lock_guard lock(mutex_);
        counters_.changed_geometry(fault->message);
      }
      say(LiveStream::kImages, true,
          fault->message + "; the calibration is not used any more, frames are not valid from here on", *fault);
    }
  }
  if (!geometry_changed_) return frame;
  auto invalid = std::make_shared<TrackedFrame>(*frame);
  invalid->frame.status = "INVALID";
  return invalid;
}

void LiveSession::Worker::say_tracking(const TrackedFrame& frame) {
  if (frame.tracked) {
    if (const auto count = lost_.fine(frame.frame.arrival_s)) {
      say(LiveStream::kTracker, false, "tracks again; " + std::to_string(*count) + " frames have no place");
    }
    return;
  }
  if (!lost_.fault(frame.frame.arrival_s)) return;
  std::string why;
  for (const NamedPose& pose : frame.poses) {
    if (!pose.pose.valid()) why += (why.empty() ? "" : ", ") + printable(pose.transform) + " is " + pose.pose.status;
  }
  say(LiveStream::kTracker, true,
      "has lost the probe (" + (why.empty() ? "it gives no poses" : printable(why, 200)) +
          "); frames are not valid until it is back");
}

void LiveSession::Worker::say_dropped() {
  std::uint64_t dropped;
  {
    const std::lock_guard lock(mutex_);
    dropped = counters_.dropped_frames();
  }
  const double now_s = live_clock_s();
  if (dropped > dropped_told_) {
    dropped_told_ = dropped;
    if (full_.fault(now_s)) say(LiveStream::kImages, true, "sends faster than frames can be used; some are dropped");
  } else if (full_.fine(now_s)) {
    say(LiveStream::kImages, false, "frames are no longer dropped; " + std::to_string(dropped) + " were in all");
  }
}

void LiveSession::Worker::say(LiveStream stream, bool warning, const std::string& message,
                              std::optional<GeometryFault> geometry) {
  const std::string text = printable(source_of(stream), 100) + ": " + message;
  const SessionEvent event{stream, {}, warning, live_clock_s(), text, std::move(geometry)};
  const std::lock_guard lock(listeners_mutex_);
  for (SessionListener* listener : listeners_) listener->on_event(event);
}

bool LiveSession::Worker::ended() const {
  const std::lock_guard lock(mutex_);
  return counters_.images_ended() && waiting_frames_ == 0;
}

SessionStatistics LiveSession::Worker::statistics() const {
  const std::lock_guard lock(mutex_);
  SessionStatistics stats = counters_.now();
  stats.waiting = waiting_frames_;
  return stats;
}

SharedFrame LiveSession::Worker::latest_frame() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

}  // namespace fathom
