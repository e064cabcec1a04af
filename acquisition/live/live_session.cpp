#include "acquisition/live/live_session.h"

#include <utility>

#include "acquisition/live/session_worker.h"
#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

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
