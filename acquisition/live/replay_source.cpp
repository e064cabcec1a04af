#include "acquisition/live/replay_source.h"

#include <algorithm>
#include <utility>

#include "acquisition/live/source_address.h"
#include "acquisition/live/source_thread.h"
#include "acquisition/rigid.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/statistics.h"

namespace fathom {

namespace {

// When frames were made, from the first on, and when the next round of a loop begins.
struct Timing {
  std::vector<double> frames_s;
  double round_s = 0.0;
};

// The usual time from a stamped frame to the next, shared out to those between; 1 / kRateWithoutStamps_hz where there
// is none.
double usual_interval_s(const std::vector<std::pair<std::size_t, double>>& stamped) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < stamped.size(); ++i) {
    const double interval_s =
        (stamped[i].second - stamped[i - 1].second) / static_cast<double>(stamped[i].first - stamped[i - 1].first);
    if (interval_s > 0.0) intervals_s.push_back(interval_s);
  }
  return intervals_s.empty() ? 1.0 / kRateWithoutStamps_hz : median(std::move(intervals_s));
}

Timing timing_of(const RecordingHeader& header) {
  std::vector<std::pair<std::size_t, double>> stamped;
  for (std::size_t i = 0; i < header.frames.size(); ++i) {
    if (header.frames[i].time_s) stamped.emplace_back(i, *header.frames[i].time_s);
  }
  const double usual_s = usual_interval_s(stamped);
  if (stamped.empty()) stamped.emplace_back(0, 0.0);
  Timing timing;
  std::size_t next = 0;  // the first stamped frame at or after this one
  for (std::size_t i = 0; i < header.frames.size(); ++i) {
    while (next < stamped.size() && stamped[next].first < i) ++next;
    const auto& [after, after_s] = stamped[std::min(next, stamped.size() - 1)];
    const auto& [before, before_s] = stamped[next == 0 ? 0 : next - 1];
    double slope_s = usual_s;
    if (after > before && i <= after) slope_s = (after_s - before_s) / static_cast<double>(after - before);
    timing.frames_s.push_back(after_s + slope_s * (static_cast<double>(i) - static_cast<double>(after)));
  }
  if (timing.frames_s.empty()) return timing;
  const double first_s = timing.frames_s.front();
  for (double& time_s : timing.frames_s) time_s -= first_s;
  timing.round_s = *std::max_element(timing.frames_s.begin(), timing.frames_s.end()) + usual_s;
  return timing;
}

class ReplaySource : public LiveSource {
 public:
  ReplaySource(std::string name, std::string file, std::unique_ptr<Recording> recording, const ReplayOptions& options)
      : name_(std::move(name)), file_(std::move(file)), options_(options), recording_(std::move(recording)) {
    options_.check();
  }

  const std::string& name() const override { return name_; }

  void start(LiveListener& listener) override {
    if (!recording_) recording_ = open_recording(file_);
    if (recording_->header().frame_count() == 0)
      throw Error(recording_->name() + ": has no frames to replay; give another recording");
    listener_ = &listener;
    thread_.start(name_, listener, [this](std::stop_token stop) { play(stop); });
  }

  void stop() override { thread_.stop(); }

 private:
  void tell(SourceState state, const std::string& what) { listener_->on_event(make_event(state, name_, what)); }

  void play(const std::stop_token& stop) {
    const RecordingHeader& header = recording_->header();
    const bool stamped =
        std::any_of(header.frames.begin(), header.frames.end(), [](const FrameHeader& f) { return f.time_s; });
    tell(SourceState::kRunning, "started");
    if (!stamped) {
      tell(SourceState::kRunning,
           "frames have no time stamps; played at " + format_real(kRateWithoutStamps_hz) + " frames a second");
    }
    left_out_.assign(header.transforms.size(), false);
    const Timing timing = timing_of(header);
    double begin_s = live_clock_s();
    std::uint64_t number = 0;
    do {
      for (std::size_t i = 0; i < header.frames.size(); ++i, ++number) {
        if (!play_frame(stop, i, number, begin_s + timing.frames_s[i] / options_.speed)) return;
      }
      begin_s += timing.round_s / options_.speed;
    } while (options_.loop);
    tell(SourceState::kEnded, "played to its end, " + std::to_string(number) + " frames");
  }

  // Returns false when asked to stop.
  bool play_frame(const std::stop_token& stop, std::size_t index, std::uint64_t number, double time_s) {
    const FrameHeader& header = recording_->header().frames[index];
    const auto image = read_image(index);
    if (!wait_until(stop, time_s)) return false;
    send_poses(header, time_s);
    if (!image) return true;
    LiveFrame frame;
    frame.image = *image;
    frame.number = number;
    frame.time_s = time_s;
    frame.device_time_s = header.time_s;
    frame.status = header.image_status;
    frame.fields = header.fields;
    frame.arrival_s = live_clock_s();
    listener_->on_frame(std::move(frame));
    return true;
  }

  // Read before it is due. Empty where there is none, or it is damaged.
  std::optional<cv::Mat> read_image(std::size_t index) {
    if (!recording_->header().has_images()) return std::nullopt;
    try {
      cv::Mat image = recording_->image(static_cast<int>(index));
      // A view of the file is gone with the recording; a frame lives as long as its receiver wants.
      return image.u == nullptr ? image.clone() : image;
    } catch (const Error& error) {
      listener_->on_event(
          {SourceState::kRunning, live_clock_s(), "frame " + std::to_string(index) + " is lost: " + error.what()});
      return std::nullopt;
    }
  }

  void send_poses(const FrameHeader& header, double time_s) {
    for (std::size_t t = 0; t < header.poses.size(); ++t) {
      if (!header.poses[t]) continue;
      const std::string& transform = recording_->header().transforms[t];
      if (header.poses[t]->valid() && !is_rigid(header.poses[t]->matrix)) {
        if (!left_out_[t]) tell(SourceState::kRunning, transform + " is not rigid, so no tracker's; left out");
        left_out_[t] = true;
        continue;
      }
      listener_->on_sample({transform, *header.poses[t], time_s, live_clock_s(), header.time_s});
    }
  }

  std::string name_;
  std::string file_;
  ReplayOptions options_;
  std::unique_ptr<Recording> recording_;
  LiveListener* listener_ = nullptr;
  std::vector<bool> left_out_;  // of the recording's transforms
  SourceThread thread_;
};

std::unique_ptr<LiveSource> make_from_text(const std::string& source) {
  const SourceAddress address = parse_source(source, {"loop", "speed"});
  ReplayOptions options;
  options.speed = address.number("speed", options.speed, ReplayOptions::kMinSpeed, ReplayOptions::kMaxSpeed);
  options.loop = address.flag("loop");
  return std::make_unique<ReplaySource>(source, address.target, nullptr, options);
}

}  // namespace

void ReplayOptions::check() const {
  if (!(speed >= kMinSpeed && speed <= kMaxSpeed)) {
    throw Error("replay: there is no such speed; choose from " + format_real(kMinSpeed) + " to " +
                format_real(kMaxSpeed));
  }
}

std::unique_ptr<LiveSource> make_replay(std::string name, std::unique_ptr<Recording> recording,
                                        const ReplayOptions& options) {
  return std::make_unique<ReplaySource>(std::move(name), std::string(), std::move(recording), options);
}

void add_replay_sources(SourceRegistry& registry) {
  registry.add("replay", {"replay:FILE[?speed=1][&loop=1]", "a recording, played as if it were being made",
                          make_from_text, [] { return std::vector<FoundDevice>(); }});
}

}  // namespace fathom
