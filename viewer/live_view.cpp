#include "viewer/live_view.h"

#include <algorithm>
#include <utility>

#include "registration/geometry_watch.h"
#include "registration/judge_folder.h"
#include "sim/live_simulation.h"

namespace fathom {

namespace {

constexpr std::size_t kMostEvents = 50;
constexpr std::size_t kMostDelays = 2000;

}  // namespace

class LiveView::Listener : public SessionListener {
 public:
  explicit Listener(std::function<void()> wake) : wake_(std::move(wake)) {}

  void on_frame(const SharedFrame&) override { wake_(); }
  void on_event(const SessionEvent& event) override {
    const std::lock_guard lock(mutex_);
    if (events_.size() >= kMostEvents) events_.erase(events_.begin());
    events_.push_back(event);
  }
  std::vector<SessionEvent> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    events_.clear();
  }

 private:
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::vector<SessionEvent> events_;
};

LiveView::LiveView(std::function<void()> wake)
    : sources_(all_sources()), listener_(std::make_unique<Listener>(std::move(wake))) {}

LiveView::~LiveView() {
  if (recorder_) recorder_->end();
  if (session_) session_->stop();
}

void LiveView::look_for_devices(Worker& worker) {
  const auto work = [this, sources = sources_](const Progress&) -> std::function<void()> {
    std::vector<FoundDevice> found;
    for (const auto& [name, scheme] : sources.schemes()) {
      if (!scheme.find) continue;
      for (FoundDevice& device : scheme.find()) found.push_back(std::move(device));
    }
    return [this, found] { devices_ = found; };
  };
  worker.start({"devices", "Looking for devices", work, {}});
}

void LiveView::connect(const std::string& images, const std::string& tracker) {
  disconnect();
  listener_->clear();
  delays_s_.clear();
  shown_ = 0;
  auto image_source = sources_.make(images);
  auto tracker_source = tracker.empty() || tracker == images ? nullptr : sources_.make(tracker);
  SessionOptions options;
  options.watch_geometry = watching(std::make_shared<GeometryWatch>());
  auto session = std::make_unique<LiveSession>(std::move(image_source), std::move(tracker_source), options);
  session->add(*listener_);
  session->start();
  session_ = std::move(session);
}

void LiveView::disconnect() {
  if (recorder_) {
    recorder_->end();
    if (session_) session_->remove(*recorder_);
  }
  if (session_) session_->stop();
  recorder_.reset();
  session_.reset();
}

std::vector<SessionEvent> LiveView::events() const { return listener_->events(); }

void LiveView::record(const std::filesystem::path& folder, bool gated) {
  RecorderOptions options;
  if (gated) options.gate.emplace();
  auto recorder = std::make_shared<Recorder>(folder, options);
  verdict_.reset();
  folder_ = folder;
  session_->add(*recorder);
  recorder->record();
  recorder_ = std::move(recorder);
}

void LiveView::pause() { recorder_->pause(); }

void LiveView::go_on() { recorder_->record(); }

void LiveView::new_sweep() { recorder_->new_sweep(); }

void LiveView::end(Worker& worker, std::function<void(const std::string& error)> failed) {
  recorder_->end();
  session_->remove(*recorder_);
  const auto work = [this, recorder = std::exchange(recorder_, nullptr),
                     folder = folder_](const Progress&) -> std::function<void()> {
    recorder->finish();
    const SweepVerdict verdict = judge_folder(folder, nullptr, {});
    return [this, verdict] { verdict_ = verdict; };
  };
  worker.start({"finish recording", "Finishing the recording", work, std::move(failed)});
}

void LiveView::note_shown(const SharedFrame& frame) {
  ++shown_;
  if (delays_s_.size() < kMostDelays) delays_s_.push_back(live_clock_s() - frame->frame.arrival_s);
}

std::optional<double> LiveView::delay_p95_s() const {
  if (delays_s_.size() < 20) return std::nullopt;
  std::vector<double> sorted = delays_s_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[sorted.size() * 95 / 100];
}

}  // namespace fathom
