#include "acquisition/live/fault_log.h"

#include "acquisition/live/source_thread.h"

namespace fathom {

void FaultLog::add(LiveListener& listener, const std::string& source, const std::string& fault) {
  ++count_;
  ++untold_;
  last_ = fault;
  tell_due(listener, source);
}

void FaultLog::tell_due(LiveListener& listener, const std::string& source) {
  if (live_clock_s() >= next_s_) tell_rest(listener, source);
}

void FaultLog::tell_rest(LiveListener& listener, const std::string& source) {
  if (untold_ == 0) return;
  const std::string others = untold_ > 1 ? " (and " + std::to_string(untold_ - 1) + " more)" : "";
  listener.on_event(make_event(SourceState::kRunning, source, last_ + others));
  untold_ = 0;
  next_s_ = live_clock_s() + kPause_s;
}

}  // namespace fathom
