#include "acquisition/live/live_session.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <variant>

#include "acquisition/live/fault_run.h"
#include "acquisition/live/frame_matcher.h"
#include "acquisition/live/rate_meter.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kMostItems = 100000;       // samples and events in the queue: seconds of any tracker
constexpr std::size_t kMostTransformsTold = 64;  // as many as frames have poses

struct StreamEvent {
  LiveStream stream;
  SourceEvent event;
};
using Item = std::variant<LiveFrame, TrackerSample, StreamEvent>;

std::size_t bytes_of(const cv::Mat& image) { return image.total() * image.elemSize(); }

}  // namespace

void SessionOptions::check() const {
  const auto require = [](double value, double low, double high, const char* name) {
    if (value >= low && value <= high) return;
    throw Error(std::string(name) + " is " + format_real(value) + " s; choose one from " + format_real(low) + " to " +
                format_real(high));
  };
  require(max_gap_s, 0.001, 10.0, "the longest gap between tracker samples");
  require(max_wait_s, 0.0, 10.0, "the longest wait for a tracker sample");
  if (max_waiting_frames == 0) throw Error("the session's queue has room for 0 frames; give it one at least");
}

class LiveSession::Worker {
 public:
  Worker(std::unique_ptr<LiveSource> images, std::unique_ptr<LiveSource> tracker, const SessionOptions& options)
      : options_(options),
        images_(std::move(images)),
        tracker_(std::move(tracker)),
        matcher_(options, tracker_ == nullptr) {
    options.check();
    assert(images_);
    stats_.images.source = images_->name();
    stats_.tracker.source = tracker_ ? tracker_->name() : images_->name();
  }

  void start();
  void stop();
  void add(SessionListener& listener);
  void remove(SessionListener& listener);
  bool ended() const;
  SessionStatistics statistics() const;
  SharedFrame latest_frame() const;

 private:
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
  void count_transform(const TrackerSample& sample);
  void deliver(const SharedFrame& frame);
  void say_tracking(const TrackedFrame& frame);
  void say_dropped();
  void say(LiveStream stream, bool warning, const std::string& message, std::optional<SourceState> state = {});
  const std::string& source_of(LiveStream stream) const {
    return stream == LiveStream::kImages ? stats_.images.source : stats_.tracker.source;
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
  SessionStatistics stats_;
  RateMeter image_rate_;
  RateMeter sample_rate_;
  std::vector<RateMeter> transform_rates_;
  std::optional<double> newest_image_s_;
  std::optional<double> newest_sample_s_;
  std::optional<std::uint64_t> last_number_;
  SharedFrame latest_;

  std::mutex listeners_mutex_;  // held while they are called
  std::vector<SessionListener*> listeners_;

  // Of the worker's thread alone.
  FrameMatcher matcher_;
  FaultRun lost_;
  FaultRun bad_image_times_;
  FaultRun bad_sample_times_;
  FaultRun bad_poses_;
  FaultRun full_;
  std::uint64_t dropped_told_ = 0;
};

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
    StreamStatistics& stream = stats_.images;
    ++stream.received;
    if (last_number_ && frame.number > *last_number_ + 1) stream.lost += frame.number - *last_number_ - 1;
    last_number_ = frame.number;
    image_rate_.count(live_clock_s());
    newest_image_s_ = frame.time_s;
    const std::size_t bytes = bytes_of(frame.image);
    const bool full = waiting_frames_ >= options_.max_waiting_frames ||
                      (waiting_frames_ > 0 && waiting_bytes_ + bytes > options_.max_waiting_bytes);
    if (full) {
      ++stream.dropped;
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
    ++stats_.tracker.received;
    sample_rate_.count(live_clock_s());
    newest_sample_s_ = sample.time_s;
    if (queue_.size() >= kMostItems) {
      ++stats_.tracker.dropped;
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
    const cv::Mat& image = frame.image;
    changed = stats_.width > 0 &&
              (image.cols != stats_.width || image.rows != stats_.height || image.type() != stats_.pixel_type);
    stats_.format_changes += changed ? 1 : 0;
    stats_.width = image.cols;
    stats_.height = image.rows;
    stats_.pixel_type = image.type();
  }
  if (changed) {
    say(LiveStream::kImages, true,
        "its images are now " + std::to_string(frame.image.cols) + " x " + std::to_string(frame.image.rows) +
            " pixels; a calibration made for the former ones does not hold");
  }
  if (!matcher_.add(std::move(frame))) {
    {
      const std::lock_guard lock(mutex_);
      ++stats_.images.bad_time;
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
    stats_.tracker.bad_time += in_time ? 0 : 1;
    count_transform(sample);
  }
  const std::lock_guard lock(listeners_mutex_);
  for (SessionListener* listener : listeners_) listener->on_sample(sample);
}

// With the mutex held.
void LiveSession::Worker::count_transform(const TrackerSample& sample) {
  auto found = std::find_if(stats_.transforms.begin(), stats_.transforms.end(),
                            [&](const TransformStatistics& t) { return t.transform == sample.transform; });
  if (found == stats_.transforms.end()) {
    if (stats_.transforms.size() == kMostTransformsTold) return;
    stats_.transforms.push_back({.transform = sample.transform, .last = {}});
    transform_rates_.emplace_back();
    found = stats_.transforms.end() - 1;
  }
  found->last = sample.pose;
  found->age_s = sample.time_s;  // made an age when asked for
  ++found->samples;
  found->not_valid += sample.pose.valid() ? 0 : 1;
  transform_rates_[static_cast<std::size_t>(found - stats_.transforms.begin())].count(live_clock_s());
}

void LiveSession::Worker::handle(StreamEvent event) {
  {
    const std::lock_guard lock(mutex_);
    const auto note = [&](StreamStatistics& stream) {
      stream.state = event.event.state;
      stream.message = event.event.message;
    };
    if (event.stream == LiveStream::kImages) note(stats_.images);
    if (event.stream == LiveStream::kTracker || !tracker_) note(stats_.tracker);
  }
  if (event.stream == LiveStream::kTracker || !tracker_) {
    matcher_.expect_samples(event.event.state == SourceState::kConnecting ||
                            event.event.state == SourceState::kRunning);
  }
  const bool bad = event.event.state == SourceState::kConnecting || event.event.state == SourceState::kFailed;
  const std::lock_guard lock(listeners_mutex_);
  const SessionEvent told{event.stream, event.event.state, bad, event.event.time_s, event.event.message};
  for (SessionListener* listener : listeners_) listener->on_event(told);
}

void LiveSession::Worker::deliver(const SharedFrame& frame) {
  say_tracking(*frame);
  {
    const std::lock_guard lock(listeners_mutex_);
    for (SessionListener* listener : listeners_) listener->on_frame(frame);
  }
  const std::lock_guard lock(mutex_);
  ++stats_.frames;
  stats_.invalid_frames += frame->valid() ? 0 : 1;
  stats_.tracked = frame->tracked;
  --waiting_frames_;
  waiting_bytes_ -= bytes_of(frame->frame.image);
  latest_ = frame;
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
    dropped = stats_.images.dropped;
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
                              std::optional<SourceState> state) {
  const SessionEvent event{stream, state, warning, live_clock_s(), printable(source_of(stream), 100) + ": " + message};
  const std::lock_guard lock(listeners_mutex_);
  for (SessionListener* listener : listeners_) listener->on_event(event);
}

bool LiveSession::Worker::ended() const {
  const std::lock_guard lock(mutex_);
  const SourceState state = stats_.images.state;
  return (state == SourceState::kEnded || state == SourceState::kFailed) && waiting_frames_ == 0;
}

SessionStatistics LiveSession::Worker::statistics() const {
  const std::lock_guard lock(mutex_);
  SessionStatistics stats = stats_;
  const double now_s = live_clock_s();
  stats.waiting = waiting_frames_;
  stats.images.rate_hz = image_rate_.rate_hz(now_s);
  stats.tracker.rate_hz = sample_rate_.rate_hz(now_s);
  if (newest_image_s_) stats.images.age_s = now_s - *newest_image_s_;
  if (newest_sample_s_) stats.tracker.age_s = now_s - *newest_sample_s_;
  for (std::size_t t = 0; t < stats.transforms.size(); ++t) {
    stats.transforms[t].age_s = now_s - stats.transforms[t].age_s;
    stats.transforms[t].rate_hz = transform_rates_[t].rate_hz(now_s);
  }
  return stats;
}

SharedFrame LiveSession::Worker::latest_frame() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

LiveSession::LiveSession(std::unique_ptr<LiveSource> images, std::unique_ptr<LiveSource> tracker,
                         const SessionOptions& options)
    : worker_(std::make_unique<Worker>(std::move(images), std::move(tracker), options)) {}

LiveSession::~LiveSession() { stop(); }

void LiveSession::add(SessionListener& listener) { worker_->add(listener); }
void LiveSession::remove(SessionListener& listener) { worker_->remove(listener); }
void LiveSession::start() { worker_->start(); }
void LiveSession::stop() { worker_->stop(); }
bool LiveSession::ended() const { return worker_->ended(); }
SessionStatistics LiveSession::statistics() const { return worker_->statistics(); }
SharedFrame LiveSession::latest_frame() const { return worker_->latest_frame(); }

}  // namespace fathom
