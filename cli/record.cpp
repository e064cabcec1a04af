#include <chrono>
#include <iomanip>
#include <iostream>
#include <memory>
#include <mutex>
#include <sstream>
#include <thread>

#include <unistd.h>

#include "acquisition/live/live_session.h"
#include "acquisition/live/recorder.h"
#include "cli/command.h"
#include "cli/live_verdict.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "core/printable.h"
#include "registration/cropped_source.h"
#include "registration/geometry_watch.h"
#include "sim/live_simulation.h"

namespace fathom {

namespace {

constexpr double kPatience_s = 30.0;  // for the first frame
constexpr auto kLookInterval = std::chrono::milliseconds(20);
constexpr std::size_t kMostWarnings = 100;  // told at the end; a bad line may give thousands

struct RecordCommand {
  std::string images;
  std::string tracker;
  std::string out;
  std::optional<double> seconds;
  std::optional<std::uint64_t> frames;
  bool gated = false;
  std::string presets;
  std::string preset;
  VerdictInput verdict;
  SessionOptions session;
  RecorderOptions recorder;
  bool json = false;
};

/// Keeps what the user must know until it can be printed.
class Warnings : public SessionListener {
 public:
  void on_frame(const SharedFrame&) override {}
  void on_event(const SessionEvent& event) override {
    if (!event.warning) return;
    // At once: who looks at the patient has to scan again.
    if (event.geometry) std::cerr << "\nfathom: warning: " << printable(event.message, 300) << std::endl;
    const std::lock_guard lock(mutex_);
    if (warnings_.size() < kMostWarnings) warnings_.push_back(printable(event.message, 300));
  }
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::move(warnings_);
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> warnings_;
};

std::string now_utc() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts = {};
  ::gmtime_r(&now, &parts);
  return (std::ostringstream() << std::put_time(&parts, "%Y-%m-%dT%H:%M:%SZ")).str();
}

const char* doing(const RecorderStatus& status) {
  if (status.state == RecorderState::kWaiting) return "hold the probe still";
  if (status.state != RecorderState::kRecording) return "ended";
  return status.gate == GateState::kReady ? "sweep now" : "recording";
}

/// One line that is drawn over itself, on a terminal.
void show(const SessionStatistics& session, const RecorderStatus& status) {
  if (::isatty(STDERR_FILENO) == 0) return;
  std::cerr << "\r\033[K" << doing(status) << ": " << status.frames << " frames, " << status.invalid_frames
            << " not valid, " << number_text(session.images.rate_hz, 1) << "/s, tracker "
            << number_text(session.tracker.rate_hz, 1) << "/s" << (session.tracked ? "" : " LOST");
  if (status.dropped_frames > 0) std::cerr << ", " << status.dropped_frames << " DROPPED";
  if (status.minutes_left) std::cerr << ", disk for " << number_text(status.minutes_left, 0) << " min";
  std::cerr << std::flush;
}

/// Waits until the recording is to end.
void watch(const RecordCommand& command, LiveSession& session, Recorder& recorder) {
  const double start_s = live_clock_s();
  std::optional<double> first_s;
  double shown_s = 0.0;
  while (!was_interrupted()) {
    std::this_thread::sleep_for(kLookInterval);
    const double now_s = live_clock_s();
    const RecorderStatus status = recorder.status();
    if (status.frames > 0 && !first_s) first_s = now_s;
    if (now_s - shown_s > 0.2) {
      show(session.statistics(), status);
      shown_s = now_s;
    }
    const bool swept = command.gated && status.gate == GateState::kClosed;
    const bool long_enough = command.seconds && first_s && now_s - *first_s >= *command.seconds;
    if (swept || long_enough || status.state == RecorderState::kEnded || session.ended()) break;
    if (now_s - start_s > kPatience_s && session.statistics().frames == 0) {
      throw Error(printable(command.images, 300) + ": has sent no frame for " + number_text(kPatience_s, 0) +
                  " s; look whether the device is on and connected");
    }
  }
  if (::isatty(STDERR_FILENO) != 0) std::cerr << "\r\033[K";
}

/// The preset that was named; empty where none was. Throws Error where there is none of this name.
std::optional<ImagePreset> preset_of(const RecordCommand& command) {
  if (command.presets.empty()) return std::nullopt;
  const std::vector<ImagePreset> presets = read_image_presets(command.presets);
  std::string names;
  for (const ImagePreset& preset : presets) {
    if (preset.name == command.preset) return preset;
    names += (names.empty() ? "" : ", ") + printable(preset.name, 100);
  }
  throw Error(printable(command.presets, 300) + ": has no preset \"" + printable(command.preset, 100) +
              "\"; choose one of: " + names);
}

struct Recorded {
  FinishedRecording finished;
  RecorderStatus status;
  SessionStatistics session;
  std::optional<ImageShape> shape;
  std::vector<std::string> warnings;
};

/// Ends the recording. Where nothing was recorded because the image source has failed, its own words say so.
FinishedRecording finished(Recorder& recorder, const SessionStatistics& session) {
  if (recorder.status().frames == 0 && session.images.state == SourceState::kFailed) {
    recorder.discard_if_empty();
    throw Error(session.images.message);
  }
  return recorder.finish();
}

/// What has gone by the end of the recording, and what to do.
std::vector<std::string> what_has_gone(const RecordCommand& command, const Recorded& recorded) {
  std::vector<std::string> gone;
  const auto look = [&](const StreamStatistics& stream) {
    const std::string name = printable(stream.source, 200);
    if (stream.state == SourceState::kConnecting || stream.state == SourceState::kFailed) {
      gone.push_back(name + ": was gone when the recording ended; check that it is on and connected, then record " +
                     "again what is missing");
    }
  };
  look(recorded.session.images);
  if (recorded.session.tracker.source != recorded.session.images.source) look(recorded.session.tracker);
  const bool too_few = command.frames && recorded.status.frames < *command.frames;
  const bool too_short = command.seconds && recorded.status.duration_s < *command.seconds;
  if (recorded.session.images.state == SourceState::kEnded && (too_few || too_short)) {
    gone.push_back(printable(recorded.session.images.message, 250) + "; the recording ended with it");
  }
  return gone;
}

Recorded record(const RecordCommand& command, const std::optional<ImagePreset>& preset) {
  const SourceRegistry sources = all_sources();
  auto images = sources.make(command.images);
  auto tracker = command.tracker.empty() || command.tracker == command.images ? nullptr : sources.make(command.tracker);
  RecorderOptions options = command.recorder;
  options.max_frames = command.frames;
  if (command.gated) options.gate.emplace();
  options.fields = {{"StartTime", now_utc()},
                    {"ImageSource", command.images},
                    {"TrackerSource", command.tracker.empty() ? command.images : command.tracker}};
  if (preset) {
    images = std::make_unique<CroppedSource>(std::move(images), *preset);
    options.fields.emplace_back("ImagePreset", preset->name);
  }
  const auto geometry = std::make_shared<GeometryWatch>();
  SessionOptions session_options = command.session;
  session_options.watch_geometry = watching(geometry);
  LiveSession session(std::move(images), std::move(tracker), session_options);
  Warnings warnings;
  Recorder recorder(command.out, options);
  session.add(warnings);
  session.add(recorder);
  recorder.record();
  try {
    session.start();
    watch(command, session, recorder);
  } catch (const Error&) {
    session.stop();
    recorder.discard_if_empty();
    throw;
  }
  recorder.end();
  session.stop();
  Recorded recorded;
  recorded.warnings = warnings.take();
  recorded.session = session.statistics();
  recorded.shape = geometry->shape();
  recorded.finished = finished(recorder, recorded.session);
  recorded.status = recorder.status();
  if (!recorded.status.message.empty()) recorded.warnings.push_back(recorded.status.message);
  for (std::string& gone : what_has_gone(command, recorded)) recorded.warnings.push_back(std::move(gone));
  return recorded;
}

void run(const RecordCommand& command) {
  const auto preset = preset_of(command);
  auto calibration = calibration_of(command.verdict);
  if (calibration && preset) calibration = cropped(*calibration, *preset);
  Recorded recorded = record(command, preset);
  const SweepVerdict verdict = verdict_on(command.out, command.verdict, calibration);
  const std::uint64_t dropped = recorded.status.dropped_frames + recorded.session.images.dropped;
  const std::string& fault = recorded.session.geometry_fault;
  if (command.json) {
    print_json({{"frames", recorded.finished.frames},
                {"dropped_frames", dropped},
                {"lost_frames", recorded.session.images.lost},
                {"invalid_frames", recorded.finished.invalid_frames},
                {"duration_s", recorded.finished.duration_s},
                {"tracker_samples", recorded.status.samples},
                {"geometry_fault", fault.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(fault)},
                {"image_shape", shape_json(recorded.shape)},
                {"verdict", verdict_json(verdict)},
                {"warnings", recorded.warnings},
                {"out", command.out}});
    return;
  }
  std::cout << "recorded " << recorded.finished.frames << " frames in " << number_text(recorded.finished.duration_s, 2)
            << " s to " << command.out << "\n";
  print_table({{"not valid", std::to_string(recorded.finished.invalid_frames)},
               {"dropped", std::to_string(dropped)},
               {"lost before they arrived", std::to_string(recorded.session.images.lost)},
               {"tracker samples", std::to_string(recorded.status.samples)},
               {"picture", shape_text(recorded.shape)}});
  print_verdict(verdict);
  for (const std::string& warning : recorded.warnings) std::cout << "warning: " << warning << "\n";
}

}  // namespace

void add_record(CLI::App& app) {
  auto options = std::make_shared<RecordCommand>();
  CLI::App* command = app.add_subcommand("record", "Record images and poses from live sources");
  std::string forms;
  const SourceRegistry sources = all_sources();
  for (const auto& [name, scheme] : sources.schemes()) forms += (forms.empty() ? "" : ", ") + scheme.form;
  command->add_option("--image", options->images, "Where images come from: " + forms)->required();
  command->add_option("--tracker", options->tracker, "Where poses come from (default: the image's source)");
  command->add_option("--out", options->out, "The folder to make and record into")->required();
  command->add_option("--seconds", options->seconds, "End so long after the first frame (default: at Ctrl-C)")
      ->check(above(0));
  command->add_option("--frames", options->frames, "End after so many frames")->check(CLI::Range(1, 1000000));
  command->add_flag("--gated", options->gated,
                    "Begin when the probe has been held still, end when it has moved and is still again");
  CLI::Option* presets = command->add_option(
      "--presets", options->presets, "A file of presets: picture size, depth, pixel size, and the part to keep");
  CLI::Option* preset = command->add_option("--preset", options->preset, "Which of them the scanner is set to");
  presets->needs(preset);
  preset->needs(presets);
  add_verdict_input(*command, options->verdict);
  command
      ->add_option("--max-gap-s", options->session.max_gap_s,
                   "Poses between tracker samples farther apart are not valid")
      ->check(between(0.001, 10))
      ->capture_default_str();
  command
      ->add_option("--sync-s", options->recorder.sync_interval_s,
                   "How often everything is brought onto the disk: what a power cut can cost")
      ->check(between(0.01, 60))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
