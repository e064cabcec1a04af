#include "acquisition/live/recorder.h"

#include "acquisition/live/recorder_writer.h"
#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

void RecorderOptions::check() const {
  if (!(sync_interval_s >= 0.01 && sync_interval_s <= 60.0)) {
    throw Error("the interval of syncs is " + format_real(sync_interval_s) + " s; choose one from 0.01 to 60");
  }
  if (max_waiting_frames == 0) throw Error("the recorder's queue has room for 0 frames; give it one at least");
  if (gate) gate->check();
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
void Recorder::on_event(const SessionEvent& event) { writer_->on_event(event); }
void Recorder::on_sample(const TrackerSample& sample) { writer_->on_sample(sample); }

}  // namespace fathom
