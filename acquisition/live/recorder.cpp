#include "acquisition/live/recorder.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <variant>

#include "acquisition/live/sweep_writer.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kMostItems = 100000;  // samples and marks that wait: minutes of any tracker

struct FrameItem {
  SharedFrame frame;
  int sweep = 0;
  std::size_t bytes = 0;
};
struct InvalidMark {};
using Item = std::variant<FrameItem, TrackerSample, InvalidMark>;

std::string size_text(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels";
}

}  // namespace

void RecorderOptions::check() const {
  if (!(sync_interval_s >= 0.01 && sync_interval_s <= 60.0)) {
    throw Error("the interval of syncs is " + format_real(sync_interval_s) + " s; choose one from 0.01 to 60");
  }
  if (max_waiting_frames == 0) throw Error("the recorder's queue has room for 0 frames; give it one at least");
  if (gate) gate->check();
}

class Recorder::Writer {
 public:
  Writer(const std::filesystem::path& folder, const RecorderOptions& options)
      : options_((options.check(), options)), files_(folder, options.fields) {
    if (options.gate) gate_.emplace(*options.gate);
    thread_ = std::thread([this] { run(); });
  }
  ~Writer() { join(); }

  void record();
  void pause();
  void new_sweep();
  void mark_invalid();
  void end();
  RecorderStatus status() const;
  FinishedRecording finish();
  void discard_if_empty();
  void on_frame(const SharedFrame& frame);
  void on_sample(const TrackerSample& sample);

 private:
  void begin_sweep();
  bool is_wanted(const TrackedFrame& frame);
  void push(Item item);
  void run();
  void write(const FrameItem& item);
  void write(const TrackerSample& sample);
  void write(const InvalidMark& mark);
  void sync_if_due();
  void look_at_disk();
  void stop_with(const std::string& message);
  void join();

  const RecorderOptions options_;
  SweepWriter files_;  // of the thread, and of finish() when it has ended
  std::thread thread_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::deque<Item> queue_;
  std::size_t waiting_frames_ = 0;
  std::size_t waiting_bytes_ = 0;
  bool wanted_ = false;  // record(), not pause()
  bool ended_ = false;
  bool leaving_ = false;
  bool in_sweep_ = false;  // whether a frame of this sweep has come
  std::optional<StillGate> gate_;
  RecorderStatus status_;
  double first_time_s_ = 0.0;
  std::uint64_t accepted_ = 0;  // frames

  // Of the thread alone.
  bool failed_ = false;
  int written_sweep_ = -1;
  std::uint64_t sweep_first_ = 0;    // its first frame
  std::uint64_t sweep_invalid_ = 0;  // frames of it
  double last_sync_s_ = 0.0;
  bool is_dirty_ = false;
};

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

void Recorder::Writer::push(Item item) {
  {
    const std::lock_guard lock(mutex_);
    if (ended_ || queue_.size() >= kMostItems) return;
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
  const double bytes_per_s = static_cast<double>(status_.bytes) / status_.duration_s;
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
  if (status.message.empty() && status.dropped_frames > 0) {
    status.message = std::to_string(status.dropped_frames) + " frames were dropped: the disk is too slow";
  }
  return status;
}

void Recorder::Writer::discard_if_empty() {
  join();
  if (files_.frames() == 0) files_.remove();
}

FinishedRecording Recorder::Writer::finish() {
  discard_if_empty();
  if (files_.frames() == 0) {
    throw Error(printable(files_.folder().string(), 300) + ": " +
                (status_.message.empty() ? "no frame was recorded; nothing was kept" : status_.message));
  }
  files_.close();
  return finish_folder(files_.folder(), false);
}

Recorder::Recorder(const std::filesystem::path& folder, const RecorderOptions& options)
    : writer_(std::make_unique<Writer>(folder, options)) {}
Recorder::~Recorder() = default;

void Recorder::record() { writer_->record(); }
void Recorder::pause() { writer_->pause(); }
void Recorder::new_sweep() { writer_->new_sweep(); }
void Recorder::mark_invalid() { writer_->mark_invalid(); }
void Recorder::end() { writer_->end(); }
RecorderStatus Recorder::status() const { return writer_->status(); }
FinishedRecording Recorder::finish() { return writer_->finish(); }
void Recorder::discard_if_empty() { writer_->discard_if_empty(); }
void Recorder::on_frame(const SharedFrame& frame) { writer_->on_frame(frame); }
void Recorder::on_sample(const TrackerSample& sample) { writer_->on_sample(sample); }

}  // namespace fathom
