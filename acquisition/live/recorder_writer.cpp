#include "acquisition/live/recorder_writer.h"

#include <chrono>
#include <system_error>

#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kMostItems = 50'000;  // that wait, where samples are no longer taken: minutes of most trackers

std::string size_text(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels";
}

}  // namespace

void Recorder::Writer::record() {
  const std::lock_guard lock(mutex_);
  if (gate_ && gate_->state() == GateState::kClosed) gate_->open_again();
  const bool goes_on = wanted_ && !(gate_ && gate_->state() == GateState::kWaitingForStill);
  if (!goes_on) begin_sweep();
  wanted_ = true;
}

void Recorder::Writer::pause() {
  const std::lock_guard lock(mutex_);
  wanted_ = false;
}

void Recorder::Writer::new_sweep() {
  const std::lock_guard lock(mutex_);
  if (gate_) gate_->open_again();
  begin_sweep();
}

// With the mutex held.
void Recorder::Writer::begin_sweep() {
  status_.sweep += in_sweep_ ? 1 : 0;
  in_sweep_ = false;
}

void Recorder::Writer::mark_invalid() { push(InvalidMark{}); }

void Recorder::Writer::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
}

// With the mutex held.
bool Recorder::Writer::is_wanted(const TrackedFrame& frame) {
  if (ended_ || !wanted_) return false;
  if (!gate_) return true;
  const bool was_open = gate_->state() != GateState::kClosed;
  return gate_->add(frame) != GateState::kWaitingForStill && was_open;
}

void Recorder::Writer::on_frame(const SharedFrame& frame) {
  {
    const std::lock_guard lock(mutex_);
    if (frame->frame.image.empty() || !is_wanted(*frame)) return;
    const std::size_t bytes = frame->frame.image.total() * frame->frame.image.elemSize();
    in_sweep_ = true;
    if (waiting_frames_ >= options_.max_waiting_frames ||
        (waiting_frames_ > 0 && waiting_bytes_ + bytes > options_.max_waiting_bytes)) {
      ++status_.dropped_frames;
      return;
    }
    ended_ = ++accepted_ == options_.max_frames;
    ++waiting_frames_;
    waiting_bytes_ += bytes;
    queue_.push_back(FrameItem{frame, status_.sweep, bytes});
  }
  wake_.notify_one();
}

void Recorder::Writer::on_sample(const TrackerSample& sample) { push(sample); }

void Recorder::Writer::on_event(const SessionEvent& event) {
  if (event.geometry) push(GeometryLine{event.geometry->message, event.geometry->since_s});
}

void Recorder::Writer::push(Item item) {
  {
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    // Marks are few, and what they say must not be lost.
    if (queue_.size() >= kMostItems && std::holds_alternative<TrackerSample>(item)) {
      ++status_.dropped_samples;
      return;
    }
    queue_.push_back(std::move(item));
  }
  wake_.notify_one();
}

void Recorder::Writer::run() {
  std::deque<Item> items;
  bool last = false;
  while (!last) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, std::chrono::duration<double>(options_.sync_interval_s),
                     [this] { return leaving_ || !queue_.empty(); });
      items.swap(queue_);
      last = leaving_;
    }
    for (; !items.empty(); items.pop_front()) {
      try {
        if (!failed_) std::visit([this](const auto& item) { write(item); }, items.front());
        if (!failed_) sync_if_due();
      } catch (const Error& error) {
        stop_with(error.what());
      }
      if (const auto* frame = std::get_if<FrameItem>(&items.front())) {
        const std::lock_guard lock(mutex_);
        --waiting_frames_;
        waiting_bytes_ -= frame->bytes;
      }
    }
    try {
      if (!failed_) sync_if_due();
    } catch (const Error& error) {
      stop_with(error.what());
    }
  }
}

void Recorder::Writer::write(const FrameItem& item) {
  const LiveFrame& frame = item.frame->frame;
  if (!files_.accepts(frame.image)) {
    return stop_with("the images have changed to " + size_text(frame.image) +
                     "; the recording ends before, record the new ones into another folder");
  }
  if (!files_.has_room()) return stop_with("the recording is as long as one can be; go on in another folder");
  files_.write(item.frame, item.sweep);
  is_dirty_ = true;
  if (item.sweep != written_sweep_) {
    written_sweep_ = item.sweep;
    sweep_first_ = files_.frames() - 1;
    sweep_invalid_ = 0;
  }
  const bool invalid = !item.frame->valid();
  sweep_invalid_ += invalid ? 1 : 0;
  const std::lock_guard lock(mutex_);
  if (status_.frames == 0) first_time_s_ = frame.time_s;
  status_.frames = files_.frames();
  status_.invalid_frames += invalid ? 1 : 0;
  status_.duration_s = frame.time_s - first_time_s_;
  status_.bytes = files_.bytes();
}

void Recorder::Writer::write(const TrackerSample& sample) {
  files_.write(sample);
  is_dirty_ = true;
  const std::lock_guard lock(mutex_);
  ++status_.samples;
}

void Recorder::Writer::write(const InvalidMark& /*mark*/) {
  if (files_.frames() == 0) return;
  files_.write(InvalidLine{sweep_first_, files_.frames() - 1});
  const std::uint64_t frames = files_.frames() - sweep_first_;
  const std::lock_guard lock(mutex_);
  status_.invalid_frames += frames - sweep_invalid_;
  sweep_invalid_ = frames;
}

void Recorder::Writer::write(const GeometryLine& geometry) {
  files_.write(geometry);
  is_dirty_ = true;
}

void Recorder::Writer::sync_if_due() {
  const double now_s = live_clock_s();
  if (!is_dirty_ || now_s - last_sync_s_ < options_.sync_interval_s) return;
  files_.sync();
  is_dirty_ = false;
  last_sync_s_ = now_s;
  look_at_disk();
}

void Recorder::Writer::look_at_disk() {
  std::error_code code;
  const auto space = std::filesystem::space(files_.folder(), code);
  const std::lock_guard lock(mutex_);
  if (code || status_.duration_s <= 0.0) return;
  // The time is that from the first frame to the last: one frame less than the bytes are of.
  const double share = static_cast<double>(status_.frames - 1) / static_cast<double>(status_.frames);
  const double bytes_per_s = share * static_cast<double>(status_.bytes) / status_.duration_s;
  status_.minutes_left = static_cast<double>(space.available) / bytes_per_s / 60.0;
}

// On the thread: nothing more is written.
void Recorder::Writer::stop_with(const std::string& message) {
  failed_ = true;
  const std::lock_guard lock(mutex_);
  ended_ = true;
  status_.message = message;
}

void Recorder::Writer::join() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    leaving_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

RecorderStatus Recorder::Writer::status() const {
  const std::lock_guard lock(mutex_);
  RecorderStatus status = status_;
  const bool waits = gate_ && gate_->state() == GateState::kWaitingForStill;
  const bool closed = gate_ && gate_->state() == GateState::kClosed;
  if (gate_) status.gate = gate_->state();
  status.state = ended_               ? RecorderState::kEnded
                 : !wanted_ || closed ? RecorderState::kPaused
                 : waits              ? RecorderState::kWaiting
                                      : RecorderState::kRecording;
  const auto tell = [&](std::uint64_t dropped, const char* what) {
    if (dropped > 0 && status.message.empty()) {
      status.message = std::to_string(dropped) + what + " were dropped: the disk is too slow";
    }
  };
  tell(status.dropped_frames, " frames");
  tell(status.dropped_samples, " raw samples of the tracker");
  return status;
}

void Recorder::Writer::discard_if_empty() {
  join();
  if (files_.frames() == 0) files_.remove();
}

FinishedRecording Recorder::Writer::finish() {
  discard_if_empty();
  if (files_.frames() == 0) {
    const bool waited = gate_ && gate_->state() == GateState::kWaitingForStill;
    const char* nothing = waited ? "the probe was never held still, so nothing was recorded; hold it still to begin"
                                 : "no frame was recorded; nothing was kept";
    throw Error(printable(files_.folder().string(), 300) + ": " +
                (status_.message.empty() ? nothing : status_.message));
  }
  files_.close();
  return finish_folder(files_.folder(), false);
}

}  // namespace fathom
