#include "acquisition/live/source_thread.h"

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

#include "core/error.h"
#include "core/printable.h"

namespace fathom {

void SourceThread::start(std::string source, LiveListener& listener, std::function<void(std::stop_token)> body) {
  assert(!thread_.joinable());
  thread_ = std::jthread([source = std::move(source), &listener, body = std::move(body)](std::stop_token stop) {
    try {
      body(std::move(stop));
    } catch (const Error& error) {
      listener.on_event({SourceState::kFailed, live_clock_s(), error.what()});
    } catch (const std::exception& error) {
      listener.on_event(make_event(SourceState::kFailed, source, printable(error.what(), 200)));
    }
  });
}

void SourceThread::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

bool wait_until(std::stop_token stop, double time_s) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  const auto time = std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(time_s)));
  wake.wait_until(lock, stop, time, [&] { return live_clock_s() >= time_s; });
  return !stop.stop_requested();
}

SourceEvent make_event(SourceState state, const std::string& source, const std::string& what) {
  return {state, live_clock_s(), printable(source) + ": " + what};
}

}  // namespace fathom
