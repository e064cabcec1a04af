#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/live/live_session.h"
#include "acquisition/live/recorder.h"
#include "acquisition/live/source_registry.h"
#include "exam/job.h"
#include "registration/sweep_verdict.h"

namespace fathom {

/// Live work: sources that are connected, the frame that came last, and the recording under way.
class LiveView {
 public:
  /// `wake` is called on the session's thread with every frame.
  explicit LiveView(std::function<void()> wake);
  ~LiveView();

  const SourceRegistry& sources() const { return sources_; }
  /// Devices that were found so far; looked for beside the frame by look_for_devices.
  const std::vector<FoundDevice>& devices() const { return devices_; }
  void look_for_devices(Worker& worker);

  /// `tracker` empty or the same as `images`: one source gives both. Throws Error as SourceRegistry::make and
  /// LiveSession::start.
  void connect(const std::string& images, const std::string& tracker);
  void disconnect();
  bool connected() const { return session_ != nullptr; }
  SessionStatistics statistics() const { return session_->statistics(); }
  SharedFrame latest_frame() const { return session_ ? session_->latest_frame() : nullptr; }
  /// What sources said since it was connected, newest last.
  std::vector<SessionEvent> events() const;

  /// Into a new folder. Gated: sweeps begin and end when the probe is held still. Throws Error.
  void record(const std::filesystem::path& folder, bool gated);
  void pause();
  void go_on();
  void new_sweep();
  /// Ends the recording; it is finished and judged beside the frame, and then verdict() is there.
  void end(Worker& worker, std::function<void(const std::string& error)> failed);
  bool recording() const { return recorder_ != nullptr; }
  RecorderStatus status() const { return recorder_->status(); }
  const std::filesystem::path& folder() const { return folder_; }
  const std::optional<SweepVerdict>& verdict() const { return verdict_; }

  /// Of the frame shown now: seconds since it had arrived. For figures.
  void note_shown(const SharedFrame& frame);
  /// Seconds from arrival to picture that 95 of 100 frames stay below; empty before twenty.
  std::optional<double> delay_p95_s() const;
  std::uint64_t shown() const { return shown_; }

 private:
  class Listener;

  SourceRegistry sources_;
  std::vector<FoundDevice> devices_;
  std::unique_ptr<Listener> listener_;
  std::shared_ptr<Recorder> recorder_;
  std::unique_ptr<LiveSession> session_;
  std::filesystem::path folder_;
  std::optional<SweepVerdict> verdict_;
  std::vector<double> delays_s_;
  std::uint64_t shown_ = 0;
};

}  // namespace fathom
