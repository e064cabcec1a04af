#include "tests/acquisition/live/heard.h"

#include <algorithm>
#include <chrono>

namespace fathom {

void Heard::on_frame(LiveFrame frame) {
  const std::lock_guard lock(mutex_);
  frames.push_back(std::move(frame));
  changed_.notify_all();
}

void Heard::on_sample(TrackerSample sample) {
  const std::lock_guard lock(mutex_);
  samples.push_back(std::move(sample));
  changed_.notify_all();
}

void Heard::on_event(SourceEvent event) {
  const std::lock_guard lock(mutex_);
  events.push_back(std::move(event));
  changed_.notify_all();
}

bool Heard::wait_for(const std::function<bool(const Heard&)>& done, double longest_s) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(longest_s), [&] { return done(*this); });
}

bool Heard::wait_for_frames(std::size_t count, double longest_s) {
  return wait_for([count](const Heard& heard) { return heard.frames.size() >= count; }, longest_s);
}

bool Heard::wait_for_state(SourceState state, double longest_s) {
  return wait_for(
      [state](const Heard& heard) {
        return std::any_of(heard.events.begin(), heard.events.end(),
                           [state](const SourceEvent& event) { return event.state == state; });
      },
      longest_s);
}

bool Heard::was_told(const std::string& text) const {
  return std::any_of(events.begin(), events.end(),
                     [&](const SourceEvent& event) { return event.message.find(text) != std::string::npos; });
}

}  // namespace fathom
