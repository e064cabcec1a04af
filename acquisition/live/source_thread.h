#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "acquisition/live/live_source.h"

namespace fathom {

/// The thread on which a source delivers. Make it the source's last member, so that it has ended before anything that
/// it uses is gone.
class SourceThread {
 public:
  ~SourceThread() { stop(); }

  /// Runs `body` until it returns. What it throws becomes a kFailed event of the listener; `source` names the device.
  void start(std::string source, LiveListener& listener, std::function<void(std::stop_token)> body);

  /// Asks the body to end and waits until it has.
  void stop();

 private:
  std::jthread thread_;
};

/// Waits until live_clock_s() has reached `time_s`. Returns whether it has; false: asked to stop.
bool wait_until(std::stop_token stop, double time_s);

/// An event of now.
SourceEvent make_event(SourceState state, const std::string& source, const std::string& what);

}  // namespace fathom
