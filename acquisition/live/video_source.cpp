#include "acquisition/live/video_source.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "acquisition/live/clock_mapping.h"
#include "acquisition/live/frame_counter.h"
#include "acquisition/live/source_address.h"
#include "acquisition/live/source_thread.h"
#include "acquisition/live/video_capture.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr double kSlice_s = 0.05;        // how often waiting looks whether it shall stop
constexpr double kSilence_s = 3.0;       // without a picture: said
constexpr double kPause_s = 0.5;         // before looking for a lost device again
constexpr double kRateOfClip_hz = 25.0;  // of a clip that states none

class VideoSource : public LiveSource {
 public:
  VideoSource(const SourceAddress& address, const VideoOptions& options)
      : name_(address.text), address_(address.target), options_(options) {}

  const std::string& name() const override { return name_; }

  void start(LiveListener& listener) override {
    capture_ = open_video(name_, address_, options_);
    listener_ = &listener;
    thread_.start(name_, listener, [this](const std::stop_token& stop) {
      tell(SourceState::kRunning, "started");
      video_kind(address_) == VideoKind::kFile ? play(stop) : follow(stop);
      capture_.reset();
    });
  }

  void stop() override { thread_.stop(); }

 private:
  void tell(SourceState state, const std::string& what) { listener_->on_event(make_event(state, name_, what)); }

  // A clip, in its own time.
  void play(const std::stop_token& stop) {
    const double stated_hz = capture_->rate_hz();
    const double rate_hz = stated_hz > 0.0 ? stated_hz : kRateOfClip_hz;
    double begin_s = 0.0;
    LiveFrame frame;
    std::uint64_t number = 0;
    while (capture_->next(frame.image, kSlice_s) == VideoCapture::Outcome::kPicture) {
      frame.device_time_s = capture_->stamp_s();
      const double in_clip_s = frame.device_time_s.value_or(static_cast<double>(number) / rate_hz);
      if (number == 0) begin_s = live_clock_s() - in_clip_s;
      frame.time_s = begin_s + in_clip_s;
      if (!wait_until(stop, frame.time_s)) return;
      frame.number = number++;
      frame.arrival_s = live_clock_s();
      listener_->on_frame(std::exchange(frame, {}));
    }
    tell(SourceState::kEnded, "played to its end, " + std::to_string(number) + " frames");
  }

  // A device or stream.
  void follow(const std::stop_token& stop) {
    double last_s = live_clock_s();
    bool silent = false;
    bool cut = false;
    while (!stop.stop_requested()) {
      cv::Mat picture;
      const auto outcome = capture_->next(picture, kSlice_s);
      if (outcome == VideoCapture::Outcome::kPicture) {
        last_s = live_clock_s();
        silent = false;
        deliver(std::move(picture), last_s, std::exchange(cut, false));
      } else if (outcome == VideoCapture::Outcome::kNoMore) {
        cut = true;
        if (!open_again(stop)) return;
      } else if (!silent && live_clock_s() - last_s > kSilence_s) {
        silent = true;
        tell(SourceState::kRunning, "no picture comes; check the cable and the signal");
      }
    }
  }

  void deliver(cv::Mat picture, double arrival_s, bool after_cut) {
    const FrameCounter::Time time{capture_->stamp_s(), arrival_s};
    if (after_cut) {
      const auto lost = frames_.lose_until(time);
      tell(SourceState::kRunning,
           (lost ? std::to_string(*lost) : "an unknown number of") + std::string(" frames lost while it was away"));
    }
    LiveFrame frame;
    frame.image = std::move(picture);
    frame.number = frames_.next(time);
    frame.arrival_s = arrival_s;
    frame.device_time_s = time.device_s;
    frame.time_s = time.device_s ? clock_.map(*time.device_s, arrival_s) : arrival_s;
    listener_->on_frame(std::move(frame));
  }

  // Returns false when asked to stop.
  bool open_again(const std::stop_token& stop) {
    tell(SourceState::kConnecting, "is gone; waiting for it to come back");
    capture_.reset();
    clock_ = ClockMapping();
    while (wait_until(stop, live_clock_s() + kPause_s)) {
      try {
        capture_ = open_video(name_, address_, options_);
        tell(SourceState::kRunning, "is back");
        return true;
      } catch (const Error&) {
        continue;  // said already
      }
    }
    return false;
  }

  std::string name_;
  std::string address_;
  VideoOptions options_;
  std::unique_ptr<VideoCapture> capture_;
  LiveListener* listener_ = nullptr;
  FrameCounter frames_;
  ClockMapping clock_;
  SourceThread thread_;
};

std::unique_ptr<LiveSource> make_from_text(const std::string& source) {
  const SourceAddress address = parse_source(source, {"color", "height", "rate", "width"});
  constexpr double kLargest = 16384.0;
  VideoOptions options;
  options.width = static_cast<int>(address.number("width", 0.0, 1.0, kLargest));
  options.height = static_cast<int>(address.number("height", 0.0, 1.0, kLargest));
  options.rate_hz = address.number("rate", 0.0, 0.1, 1000.0);
  options.color = address.flag("color");
  return std::make_unique<VideoSource>(address, options);
}

// The name of a device that gives pictures; empty for other nodes, such as those of a camera's metadata.
std::string name_of_device(const std::filesystem::path& node) {
  const int descriptor = ::open(node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return "cannot be opened; may you use it?";
  v4l2_capability what{};
  const bool asked = ::ioctl(descriptor, VIDIOC_QUERYCAP, &what) == 0;
  ::close(descriptor);
  const bool pictures = (what.device_caps & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) != 0;
  if (!asked || !pictures) return {};
  return printable({reinterpret_cast<const char*>(what.card),
                    ::strnlen(reinterpret_cast<const char*>(what.card), sizeof what.card)});
}

std::vector<FoundDevice> find_devices() {
  std::vector<FoundDevice> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    if (!entry.path().filename().string().starts_with("video")) continue;
    const std::string name = name_of_device(entry.path());
    if (!name.empty()) found.push_back({"video:" + entry.path().string(), name});
  }
  std::sort(found.begin(), found.end(), [](const FoundDevice& a, const FoundDevice& b) { return a.source < b.source; });
  return found;
}

}  // namespace

void add_video_sources(SourceRegistry& registry) {
  registry.add("video", {"video:DEVICE, FILE or URL", "a frame grabber or camera, a film, a stream", make_from_text,
                         find_devices});
}

}  // namespace fathom
