#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/live/live_session.h"
#include "acquisition/live/recording_folder.h"
#include "acquisition/live/still_gate.h"

namespace fathom {

struct RecorderOptions {
  /// What a power cut can cost: so often everything is on the disk.
  double sync_interval_s = 1.0;
  /// What may wait for the disk; further frames are dropped, counted and told.
  std::size_t max_waiting_frames = 240;
  std::size_t max_waiting_bytes = 256u << 20;
  /// Ends after so many frames; empty: by hand.
  std::optional<std::uint64_t> max_frames = {};
  /// Sweeps begin when the probe has been held still, and end when it is still again; empty: by hand.
  std::optional<HoldStillOptions> gate = {};
  /// Further fields for the recording's header.
  std::vector<std::pair<std::string, std::string>> fields = {};

  /// Throws Error, naming the option, when a value is out of range.
  void check() const;
};

enum class RecorderState {
  kPaused,   ///< frames are let go by
  kWaiting,  ///< for the probe to be held still
  kRecording,
  kEnded  ///< by end(), by a fault, or because the images have changed: RecorderStatus::message says why
};

struct RecorderStatus {
  RecorderState state = RecorderState::kPaused;
  GateState gate = GateState::kWaitingForStill;  ///< where the recorder is gated
  std::uint64_t frames = 0;                      ///< written
  std::uint64_t invalid_frames = 0;              ///< of these
  std::uint64_t dropped_frames = 0;              ///< as the disk was too slow
  std::uint64_t samples = 0;                     ///< of the tracker, written
  std::uint64_t dropped_samples = 0;             ///< as the disk was too slow for very long
  int sweep = 0;                                 ///< the one being recorded, from 0
  double duration_s = 0.0;                       ///< from the first frame's stamp to the last one's
  std::uint64_t bytes = 0;                       ///< of pixels
  std::optional<double> minutes_left;            ///< until the disk is full, at the present rate; empty: not known yet
  std::string message;                           ///< one line: why it ended, or what it warns of; else empty
};

/// Writes what a session delivers into a recording folder, on a thread of its own: a slow disk never holds up the
/// source. Add it to the session; remove it before it goes. All functions may be called from any thread.
///
/// Frames are appended to `sweep.raw`, then to `sweep.jsonl` with their checksum, and synced every sync_interval_s, so
/// a crash costs what came since. A full disk, a fault of it, or images of another size or type end the recording; all
/// frames so far are kept, and room for finishing them is held back from the start.
class Recorder : public SessionListener {
 public:
  /// Makes the folder; recording begins with record(). Throws Error when it exists or cannot be made.
  explicit Recorder(const std::filesystem::path& folder, const RecorderOptions& options = {});
  /// Ends; where it was not finished by finish(), the folder is left to `recover`.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Begins, or goes on after pause() with another sweep: the hand has moved. Gated: waits for the probe to be held
  /// still.
  void record();
  void pause();
  void new_sweep();     ///< the next frame begins another sweep; gated: waits again
  void mark_invalid();  ///< what was recorded of this sweep so far, and what waits to be written
  void end();           ///< takes no more frames; what waits is written still

  RecorderStatus status() const;

  /// Ends, and writes the header that makes the folder a recording. Once only. Without any frame the folder is removed
  /// again. Throws Error where there is no frame or the header cannot be written: the data stay for `recover`.
  FinishedRecording finish();

  /// Ends, and removes the folder again if no frame was written.
  void discard_if_empty();

  void on_frame(const SharedFrame& frame) override;
  void on_sample(const TrackerSample& sample) override;
  void on_event(const SessionEvent& event) override;

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace fathom
