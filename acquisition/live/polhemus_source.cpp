#include "acquisition/live/polhemus_source.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "acquisition/live/clock_mapping.h"
#include "acquisition/live/polhemus_setup.h"
#include "acquisition/live/source_thread.h"
#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

// The slowest instrument measures more than 10 times a second, also with four stations.
constexpr double kSilence_s = 1.0;
constexpr double kReadWait_s = 0.1;
constexpr double kRetry_s = 0.5;
constexpr double kReportEvery_s = 1.0;
// Larger steps of the frame count are a count that was set back.
constexpr std::uint32_t kLargestLoss = 100'000;

// What went wrong on the line since it was last reported.
struct Losses {
  std::size_t noise_bytes = 0;
  std::uint64_t records = 0;

  bool any() const { return noise_bytes > 0 || records > 0; }
  std::string text() const {
    std::string text;
    if (noise_bytes > 0) text = std::to_string(noise_bytes) + " bytes on the line belong to no whole record";
    if (records > 0) text += (text.empty() ? "" : ", ") + std::to_string(records) + " records lost";
    return text;
  }
};

class PolhemusSource : public LiveSource {
 public:
  PolhemusSource(std::string name, std::function<std::unique_ptr<PolhemusLine>()> open, const PolhemusOptions& options)
      : name_(std::move(name)), open_(std::move(open)), options_(options) {}

  const std::string& name() const override { return name_; }

  void start(LiveListener& listener) override {
    connect({});
    listener_ = &listener;
    thread_.start(name_, listener, [this](std::stop_token stop) { run(stop); });
  }

  void stop() override {
    thread_.stop();
    line_.reset();
  }

 private:
  void tell(SourceState state, const std::string& what) { listener_->on_event(make_event(state, name_, what)); }

  void connect(const std::stop_token& stop) {
    line_.reset();
    auto line = open_();
    format_ = set_up_polhemus(*line, name_, options_.text, stop);
    line_ = std::move(line);
    waiting_.clear();
    frames_.clear();
    losses_ = {};
    clock_ = ClockMapping();
    last_ms_.reset();
  }

  void run(const std::stop_token& stop) {
    tell(SourceState::kRunning,
         std::string(name_of(format_.model)) + ", sending " + (options_.text ? "text" : "binary"));
    while (!stop.stop_requested()) {
      try {
        receive(stop);
        stop_polhemus(*line_, format_.model);
        return;
      } catch (const Error& error) {
        if (stop.stop_requested()) return;
        listener_->on_event({SourceState::kConnecting, live_clock_s(), error.what()});
      }
      reconnect(stop);
    }
  }

  void reconnect(const std::stop_token& stop) {
    const double lost_s = live_clock_s();
    line_.reset();
    while (wait_until(stop, live_clock_s() + kRetry_s)) {
      try {
        connect(stop);
        tell(SourceState::kRunning, "back after " + format_rounded(live_clock_s() - lost_s, 1) + " s without poses");
        return;
      } catch (const Error&) {
        // Not yet; that it is away has been said.
      }
    }
  }

  // Until asked to stop. Throws Error when the line is lost.
  void receive(const std::stop_token& stop) {
    std::array<std::uint8_t, 4096> bytes;
    double last_s = live_clock_s();
    double reported_s = last_s;
    while (!stop.stop_requested()) {
      const std::size_t count = line_->read(bytes, kReadWait_s);
      const double arrival_s = live_clock_s();
      waiting_.insert(waiting_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
      if (deliver(arrival_s)) last_s = arrival_s;
      if (arrival_s - reported_s >= kReportEvery_s) {
        report();
        reported_s = arrival_s;
      }
      if (arrival_s - last_s > kSilence_s) {
        throw Error(name_ + ": sends nothing any more; check that the instrument is on and its cable");
      }
    }
    report();
  }

  void report() {
    if (losses_.any()) tell(SourceState::kRunning, losses_.text());
    losses_ = {};
  }

  // Whether there was a record in what waits.
  bool deliver(double arrival_s) {
    bool any = false;
    std::size_t used = 0;
    while (true) {
      const PolhemusStep step = read_polhemus(std::span(waiting_).subspan(used), format_);
      if (step.used == 0) break;
      used += step.used;
      if (!step.reading) {
        losses_.noise_bytes += step.used;
        continue;
      }
      any = true;
      // What lies behind it in the buffer, and itself, took its time on the line.
      const auto behind = static_cast<double>(waiting_.size() - used + step.used);
      made_s_ = std::max(made_s_, arrival_s - behind * line_->byte_s());
      send(*step.reading, arrival_s);
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(used));
    return any;
  }

  void send(const PolhemusReading& reading, double arrival_s) {
    if (reading.frame) {
      const auto last = frames_.find(reading.station);
      if (last != frames_.end()) {
        const std::uint32_t step = *reading.frame - last->second;
        if (step > 1 && step < kLargestLoss) losses_.records += step - 1;
      }
      frames_[reading.station] = *reading.frame;
    }
    TrackerSample sample;
    sample.transform = transform_of(reading.station);
    sample.pose = polhemus_pose(reading, options_.most_distortion);
    sample.time_s = made_s_;
    sample.arrival_s = arrival_s;
    if (reading.time_ms) {
      sample.device_time_s = device_time_s(*reading.time_ms);
      sample.time_s = clock_.map(*sample.device_time_s, made_s_);
    }
    listener_->on_sample(std::move(sample));
  }

  // The instrument's clock, which starts again at 0 after 2^32 ms.
  double device_time_s(std::uint32_t time_ms) {
    if (!last_ms_) device_ms_ = time_ms;
    if (last_ms_) device_ms_ += static_cast<std::int32_t>(time_ms - *last_ms_);
    last_ms_ = time_ms;
    return static_cast<double>(device_ms_) * 1e-3;
  }

  std::string transform_of(int station) const {
    const auto index = static_cast<std::size_t>(station - 1);
    return index < options_.transforms.size() ? options_.transforms[index]
                                              : "Station" + std::to_string(station) + "ToTracker";
  }

  std::string name_;
  std::function<std::unique_ptr<PolhemusLine>()> open_;
  PolhemusOptions options_;
  LiveListener* listener_ = nullptr;
  std::unique_ptr<PolhemusLine> line_;
  PolhemusFormat format_;
  std::vector<std::uint8_t> waiting_;    // bytes that make no record yet
  std::map<int, std::uint32_t> frames_;  // last frame count of each station
  Losses losses_;
  double made_s_ = 0.0;  // when the last record began on the line; never goes back
  ClockMapping clock_;
  std::optional<std::uint32_t> last_ms_;
  std::int64_t device_ms_ = 0;
  SourceThread thread_;
};

}  // namespace

std::unique_ptr<LiveSource> make_polhemus(std::string name, std::function<std::unique_ptr<PolhemusLine>()> open,
                                          const PolhemusOptions& options) {
  return std::make_unique<PolhemusSource>(std::move(name), std::move(open), options);
}

}  // namespace fathom
