#include "sim/live_simulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "acquisition/live/default_sources.h"
#include "acquisition/live/source_address.h"
#include "acquisition/live/source_thread.h"
#include "acquisition/rigid.h"
#include "core/error.h"
#include "core/random.h"
#include "sim/phantom.h"
#include "sim/scan_plan.h"

namespace fathom {

namespace {

// Frames farther apart than this many intervals belong to different sweeps.
constexpr double kPause = 1.5;

// What one way shows, with times from 0 on.
struct Way {
  std::vector<double> times_s;
  std::vector<Eigen::Isometry3d> tracker_from_probe;
  std::vector<cv::Mat> images;
  cv::Mat black;
  Eigen::Matrix4d tracker_from_reference = Eigen::Matrix4d::Identity();
  double interval_s = 0.0;

  double duration_s() const { return times_s.back(); }

  // The last frame at or before a time on the way.
  std::size_t before(double time_s) const {
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    return after == times_s.begin() ? 0 : static_cast<std::size_t>(after - times_s.begin()) - 1;
  }

  bool is_pause(std::size_t frame, double time_s) const {
    if (frame + 1 >= times_s.size() || times_s[frame + 1] - times_s[frame] < kPause * interval_s) return false;
    return time_s > times_s[frame] + 0.5 * interval_s && time_s < times_s[frame + 1] - 0.5 * interval_s;
  }
};

Way make_way(const LiveSimulationOptions& options, const Progress& progress) {
  SimulateOptions scan = options.scan;
  // These are the live tracker's, not the frames'.
  scan.latency_s = scan.noise_mm = scan.noise_deg = 0.0;
  const SimulatedScan simulated = simulate(scan, progress);
  const RecordingHeader& header = simulated.recording->header();
  const std::size_t probe = header.transform_index("ProbeToTracker").value();
  const std::size_t reference = header.transform_index("ReferenceToTracker").value();
  Way way;
  way.interval_s = 1.0 / options.rate_hz;
  double stored_interval_s = 1.0;  // within a sweep
  for (std::size_t i = 1; i < header.frames.size(); ++i) {
    stored_interval_s = std::min(stored_interval_s, *header.frames[i].time_s - *header.frames[i - 1].time_s);
  }
  for (const FrameHeader& frame : header.frames) {
    const double frames = (*frame.time_s - *header.frames[0].time_s) / stored_interval_s;
    way.times_s.push_back(std::round(frames) * way.interval_s);
    way.tracker_from_probe.push_back(nearest_rigid(frame.poses[probe]->matrix));
  }
  way.tracker_from_reference = header.frames[0].poses[reference]->matrix;
  way.black = cv::Mat::zeros(header.height, header.width, header.pixel_type);
  way.images.resize(header.frames.size());
  cv::parallel_for_(cv::Range(0, header.frame_count()), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      way.images[static_cast<std::size_t>(i)] = simulated.recording->image(i);
  });
  return way;
}

Eigen::Vector3d gaussian(Random& random, double rms) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * (rms / std::sqrt(3.0));
}

class LiveSimulation : public LiveSource {
 public:
  LiveSimulation(std::string name, const LiveSimulationOptions& options)
      : name_(std::move(name)), options_(options), random_(options.scan.seed) {
    options_.check();
  }

  const std::string& name() const override { return name_; }

  void start(LiveListener& listener) override {
    listener_ = &listener;
    thread_.start(name_, listener, [this](const std::stop_token& stop) {
      try {
        tell(SourceState::kConnecting, "is being made ready");
        way_ = make_way(options_, [&stop](double) { return !stop.stop_requested(); });
        run(stop);
      } catch (const Cancelled&) {
        return;
      }
    });
  }

  void stop() override { thread_.stop(); }

 private:
  void tell(SourceState state, const std::string& what) { listener_->on_event(make_event(state, name_, what)); }

  void run(const std::stop_token& stop) {
    tell(SourceState::kRunning, "started");
    random_ = Random(options_.scan.seed);
    const double begin_s = live_clock_s();
    // A single frame lasts, too.
    const double end_s = options_.loop ? INFINITY : way_.duration_s() + 0.5 * way_.interval_s;
    std::uint64_t frames = 0;
    std::uint64_t samples = 0;
    while (true) {
      const double frame_s = static_cast<double>(frames) * way_.interval_s;
      const double sample_s = static_cast<double>(samples) / options_.tracker_rate_hz;
      if (std::min(frame_s, sample_s) > end_s) break;
      if (!wait_until(stop, begin_s + std::min(frame_s, sample_s))) return;
      if (sample_s <= frame_s) {
        send_sample(begin_s, sample_s);
        ++samples;
      } else {
        send_frame(begin_s, frame_s, frames++);
      }
    }
    tell(SourceState::kEnded, "the scan is done, " + std::to_string(frames) + " frames");
  }

  // To and fro.
  double on_way_s(double time_s) const {
    if (!options_.loop || way_.duration_s() == 0.0) return std::clamp(time_s, 0.0, way_.duration_s());
    const double there_and_back_s = 2.0 * way_.duration_s();
    const double folded_s = time_s - there_and_back_s * std::floor(time_s / there_and_back_s);
    return std::min(folded_s, there_and_back_s - folded_s);
  }

  void send_frame(double begin_s, double time_s, std::uint64_t number) {
    const double at_s = on_way_s(time_s);
    const std::size_t nearest = way_.before(at_s + 0.5 * way_.interval_s);
    LiveFrame frame;
    frame.image = way_.is_pause(nearest, at_s) ? way_.black : way_.images[nearest];
    frame.number = number;
    frame.time_s = begin_s + time_s;
    frame.status = "OK";
    frame.arrival_s = live_clock_s();
    listener_->on_frame(std::move(frame));
  }

  void send_sample(double begin_s, double time_s) {
    const double at_s = on_way_s(time_s - options_.scan.latency_s);
    const std::size_t before = way_.before(at_s);
    const bool lost = way_.is_pause(before, at_s);
    const Pose probe = lost ? Pose{Eigen::Matrix4d::Identity(), "OUT_OF_VIEW"} : Pose{pose_at(before, at_s), "OK"};
    listener_->on_sample({"ProbeToTracker", probe, begin_s + time_s, live_clock_s(), {}});
    listener_->on_sample(
        {"ReferenceToTracker", {way_.tracker_from_reference, "OK"}, begin_s + time_s, live_clock_s(), {}});
  }

  Eigen::Matrix4d pose_at(std::size_t before, double time_s) {
    const std::size_t after = std::min(before + 1, way_.times_s.size() - 1);
    const double interval_s = way_.times_s[after] - way_.times_s[before];
    const bool same_sweep = interval_s > 0.0 && interval_s < kPause * way_.interval_s;
    const double u = same_sweep ? (time_s - way_.times_s[before]) / interval_s : 0.0;
    const Eigen::Isometry3d& a = way_.tracker_from_probe[before];
    const Eigen::Isometry3d& b = way_.tracker_from_probe[after];
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(a.linear()).slerp(u, Eigen::Quaterniond(b.linear())).toRotationMatrix();
    pose.translation() = (1.0 - u) * a.translation() + u * b.translation();
    pose.translation() += gaussian(random_, options_.scan.noise_mm);
    const Eigen::Vector3d turn = gaussian(random_, options_.scan.noise_deg * std::numbers::pi / 180.0);
    if (turn.norm() > 0.0) pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    return pose.matrix();
  }

  std::string name_;
  LiveSimulationOptions options_;
  LiveListener* listener_ = nullptr;
  Random random_;
  Way way_;
  SourceThread thread_;
};

std::unique_ptr<LiveSource> make_from_text(const std::string& source) {
  const SourceAddress address =
      parse_source(source, {"frames", "jitter_deg", "jitter_mm", "latency_s", "loop", "noise_deg", "noise_mm", "rate",
                            "seed", "speckle", "tracker_rate"});
  const std::size_t slash = address.target.find('/');
  if (slash == std::string::npos) address.fail("is no simulation; give sim:OBJECT/PATTERN");
  LiveSimulationOptions options;
  SimulateOptions& scan = options.scan;
  scan.object = address.target.substr(0, slash);
  scan.pattern = address.target.substr(slash + 1);
  constexpr int kUsualFrames = 100;
  constexpr double kLargestSeed = 9007199254740992.0;  // 2^53: whole numbers
  const auto number = [&address](const char* name, double fallback, double most) {
    return address.number(name, fallback, 0.0, most);
  };
  scan.frames = static_cast<int>(number("frames", kUsualFrames, LiveSimulationOptions::kMostFrames));
  scan.jitter_mm = number("jitter_mm", 0.0, SimulateOptions::kMaxShift_mm);
  scan.jitter_deg = number("jitter_deg", 0.0, SimulateOptions::kMaxTurn_deg);
  scan.noise_mm = number("noise_mm", 0.0, SimulateOptions::kMaxShift_mm);
  scan.noise_deg = number("noise_deg", 0.0, SimulateOptions::kMaxTurn_deg);
  scan.latency_s = address.number("latency_s", 0.0, -SimulateOptions::kMaxLatency_s, SimulateOptions::kMaxLatency_s);
  scan.seed = static_cast<std::uint64_t>(number("seed", 1.0, kLargestSeed));
  if (address.flag("speckle")) scan.speckle.emplace();
  options.rate_hz = number("rate", options.rate_hz, LiveSimulationOptions::kHighestRate_hz);
  options.tracker_rate_hz = number("tracker_rate", options.tracker_rate_hz, LiveSimulationOptions::kHighestRate_hz);
  options.loop = !address.options.contains("loop") || address.flag("loop");
  return make_live_simulation(source, options);
}

}  // namespace

void LiveSimulationOptions::check() const {
  scan.check();
  constexpr double kLowestRate_hz = 0.1;
  if (scan.frames > kMostFrames) {
    throw Error("sim: all frames are held in memory; choose at most " + std::to_string(kMostFrames));
  }
  for (const double rate : {rate_hz, tracker_rate_hz}) {
    if (!(rate >= kLowestRate_hz && rate <= kHighestRate_hz)) {
      throw Error("sim: there is no such rate of images or tracker; choose from 0.1 to 1000 a second");
    }
  }
}

std::unique_ptr<LiveSource> make_live_simulation(std::string name, const LiveSimulationOptions& options) {
  return std::make_unique<LiveSimulation>(std::move(name), options);
}

void add_simulated_sources(SourceRegistry& registry) {
  registry.add("sim",
               {"sim:OBJECT/PATTERN", "a simulated scanner and tracker", make_from_text, [] {
                  return std::vector<FoundDevice>{{"sim:bladder/linear", "a simulated bladder, swept to and fro"}};
                }});
}

SourceRegistry all_sources() {
  SourceRegistry registry = default_sources();
  add_simulated_sources(registry);
  return registry;
}

}  // namespace fathom
