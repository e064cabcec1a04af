#include "viewer/script.h"

#include <utility>

#include "acquisition/live/live_source.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr double kPatience_s = 5.0;
constexpr double kIdlePatience_s = 60.0;
constexpr int kIdleFrames = 3;  // in a row: what a frame finds out, the next one shows

}  // namespace

Script::Script(const std::filesystem::path& file) : file_(file) {
  ScriptText text = read_script(file);
  steps_ = std::move(text.steps);
  event_of_ = std::move(text.event_of);
  width_ = text.width;
  height_ = text.height;
}

void Script::fail(const std::string& what) const {
  throw Error(file_.string() + ": event " + std::to_string(event_of_[next_]) + ", counted from 0: " + what);
}

bool Script::step(const ScriptTarget& target) {
  if (target.queued()) return true;
  if (frames_left_ > 0) {
    --frames_left_;
    return true;
  }
  // A hand's input does not wait for frames either.
  for (;;) {
    if (next_ >= steps_.size() || steps_[next_].kind == ScriptStep::Kind::kQuit) return false;
    const ScriptStep& now = steps_[next_];
    if (!run(now, target)) return true;
    ++next_;
    missing_since_s_ = wait_until_s_ = 0.0;
    idle_frames_ = 0;
    if (now.kind != ScriptStep::Kind::kMove && now.kind != ScriptStep::Kind::kInput) return true;
  }
}

bool Script::run(const ScriptStep& now, const ScriptTarget& target) {
  using Kind = ScriptStep::Kind;
  const double time_s = live_clock_s();
  if (missing_since_s_ == 0.0) missing_since_s_ = time_s;
  switch (now.kind) {
    case Kind::kMove: {
      const auto at = target.find(now.point);
      if (!at) {
        if (time_s - missing_since_s_ > kPatience_s) {
          fail("'" + now.point.item + "' is not shown; look at a picture of the window just before");
        }
        return false;
      }
      target.push({.kind = InputEvent::Kind::kMove, .x = at->x(), .y = at->y()});
      return true;
    }
    case Kind::kInput:
      target.push(now.input);
      return true;
    case Kind::kFrames:
      frames_left_ = now.count - 1;
      return true;
    case Kind::kIdle:
      idle_frames_ = target.busy() ? 0 : idle_frames_ + 1;
      if (time_s - missing_since_s_ > kIdlePatience_s) fail("work goes on for more than a minute");
      return idle_frames_ >= kIdleFrames;
    case Kind::kWait:
      if (wait_until_s_ == 0.0) wait_until_s_ = time_s + now.seconds;
      return time_s >= wait_until_s_;
    case Kind::kPicture:
      target.picture(file_.parent_path() / now.file, now.item);
      return true;
    case Kind::kDump:
      target.dump(file_.parent_path() / now.file);
      return true;
    case Kind::kKeys:
      target.keys(file_.parent_path() / now.file);
      return true;
    case Kind::kBench:
      target.bench(file_.parent_path() / now.file, now.count);
      return true;
    case Kind::kQuit:
      break;
  }
  return true;
}

}  // namespace fathom
