#include "acquisition/live/session_counters.h"

#include <algorithm>

namespace fathom {

namespace {
constexpr std::size_t kMostTransforms = 64;  // as many as frames have poses
}

SessionCounters::SessionCounters(const std::string& images, const std::string& tracker) {
  stats_.images.source = images;
  stats_.tracker.source = tracker;
}

void SessionCounters::received(const LiveFrame& frame) {
  StreamStatistics& stream = stats_.images;
  ++stream.received;
  if (last_number_ && frame.number > *last_number_ + 1) stream.lost += frame.number - *last_number_ - 1;
  last_number_ = frame.number;
  image_rate_.count(live_clock_s());
  newest_image_s_ = frame.time_s;
}

void SessionCounters::received(const TrackerSample& sample) {
  ++stats_.tracker.received;
  sample_rate_.count(live_clock_s());
  newest_sample_s_ = sample.time_s;
}

bool SessionCounters::changes_format(const cv::Mat& image) {
  const bool changed = stats_.width > 0 &&
                       (image.cols != stats_.width || image.rows != stats_.height || image.type() != stats_.pixel_type);
  stats_.format_changes += changed ? 1 : 0;
  stats_.width = image.cols;
  stats_.height = image.rows;
  stats_.pixel_type = image.type();
  return changed;
}

void SessionCounters::checked(const TrackerSample& sample) {
  auto found = std::find_if(stats_.transforms.begin(), stats_.transforms.end(),
                            [&](const TransformStatistics& t) { return t.transform == sample.transform; });
  if (found == stats_.transforms.end()) {
    if (stats_.transforms.size() == kMostTransforms) return;
    stats_.transforms.push_back({.transform = sample.transform, .last = {}});
    transforms_.emplace_back();
    found = stats_.transforms.end() - 1;
  }
  found->last = sample.pose;
  ++found->samples;
  found->not_valid += sample.pose.valid() ? 0 : 1;
  Transform& transform = transforms_[static_cast<std::size_t>(found - stats_.transforms.begin())];
  transform.rate.count(live_clock_s());
  transform.newest_s = sample.time_s;
}

void SessionCounters::delivered(const TrackedFrame& frame) {
  ++stats_.frames;
  stats_.invalid_frames += frame.valid() ? 0 : 1;
  stats_.tracked = frame.tracked;
}

void SessionCounters::changed_state(LiveStream stream, const SourceEvent& event) {
  of(stream).state = event.state;
  of(stream).message = event.message;
}

bool SessionCounters::images_ended() const {
  return stats_.images.state == SourceState::kEnded || stats_.images.state == SourceState::kFailed;
}

SessionStatistics SessionCounters::now() const {
  SessionStatistics stats = stats_;
  const double now_s = live_clock_s();
  stats.images.rate_hz = image_rate_.rate_hz(now_s);
  stats.tracker.rate_hz = sample_rate_.rate_hz(now_s);
  if (newest_image_s_) stats.images.age_s = now_s - *newest_image_s_;
  if (newest_sample_s_) stats.tracker.age_s = now_s - *newest_sample_s_;
  for (std::size_t t = 0; t < transforms_.size(); ++t) {
    stats.transforms[t].age_s = now_s - transforms_[t].newest_s;
    stats.transforms[t].rate_hz = transforms_[t].rate.rate_hz(now_s);
  }
  return stats;
}

}  // namespace fathom
