#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "acquisition/live/recorder.h"
#include "acquisition/live/sweep_writer.h"

namespace fathom {

/// The recorder itself: what the session delivers goes into a queue, and a thread takes it from there to the disk.
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
  void on_event(const SessionEvent& event);

 private:
  struct FrameItem {
    SharedFrame frame;
    int sweep = 0;
    std::size_t bytes = 0;
  };
  struct InvalidMark {};
  using Item = std::variant<FrameItem, TrackerSample, InvalidMark, GeometryLine>;

  void begin_sweep();
  bool is_wanted(const TrackedFrame& frame);
  void push(Item item);
  void run();
  void write(const FrameItem& item);
  void write(const TrackerSample& sample);
  void write(const InvalidMark& mark);
  void write(const GeometryLine& geometry);
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

}  // namespace fathom
