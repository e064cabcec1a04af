#include <chrono>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <unistd.h>

#include "acquisition/live/igtl_server.h"
#include "acquisition/live/replay_source.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/error.h"
#include "core/printable.h"
#include "sim/live_simulation.h"

namespace fathom {

namespace {

constexpr auto kLookInterval = std::chrono::milliseconds(20);
constexpr double kFlush_s = 5.0;  // in the end, for clients that are behind

struct ServeCommand {
  std::string source;
  IgtlServerOptions server;
  std::optional<double> seconds;
  std::optional<std::uint64_t> frames;
  bool once = false;
  bool json = false;
};

/// Passes on to the server, and keeps how the source is.
class Served : public LiveListener {
 public:
  explicit Served(IgtlServer& server) : server_(server) {}

  void on_frame(LiveFrame frame) override { server_.on_frame(std::move(frame)); }
  void on_sample(TrackerSample sample) override { server_.on_sample(std::move(sample)); }
  void on_event(SourceEvent event) override {
    const std::lock_guard lock(mutex_);
    last_ = std::move(event);
  }

  SourceEvent last() const {
    const std::lock_guard lock(mutex_);
    return last_;
  }

 private:
  IgtlServer& server_;
  mutable std::mutex mutex_;
  SourceEvent last_;
};

class Nobody : public LiveListener {
 public:
  void on_frame(LiveFrame) override {}
  void on_sample(TrackerSample) override {}
  void on_event(SourceEvent) override {}
};

bool is_source(const std::string& text, const SourceRegistry& sources) {
  const std::size_t colon = text.find(':');
  return colon != std::string::npos && sources.schemes().contains(text.substr(0, colon));
}

/// Sources that are played, and begin when there is somebody to see them.
std::unique_ptr<LiveSource> open_source(const ServeCommand& command, bool& played) {
  const SourceRegistry sources = all_sources();
  played = !is_source(command.source, sources) || command.source.starts_with("replay:");
  if (!is_source(command.source, sources)) {
    return make_replay(command.source, open_only_recording(command.source, "serve"), {.loop = !command.once});
  }
  auto source = sources.make(command.source);
  if (played) {
    // What is wrong with the file is to be told before anybody is waited for.
    Nobody nobody;
    source->start(nobody);
    source->stop();
  }
  return source;
}

void show(const IgtlServer& server, const SourceEvent& event) {
  if (::isatty(STDERR_FILENO) == 0) return;
  const auto counts = server.counts();
  std::cerr << "\r\033[K" << counts.clients << " clients, " << counts.frames_sent << " frames sent; "
            << printable(event.message, 100) << std::flush;
}

/// Waits for `done`, or until the user wants the end.
template <typename Done>
void wait_until_done(const IgtlServer& server, const Served& served, const Done& done) {
  while (!was_interrupted() && !done()) {
    show(server, served.last());
    std::this_thread::sleep_for(kLookInterval);
  }
}

IgtlServer::Counts serve(const ServeCommand& command) {
  bool played = false;
  const auto source = open_source(command, played);
  IgtlServerOptions options = command.server;
  if (command.frames) options.most_frames = *command.frames;
  IgtlServer server(options);
  Served served(server);
  if (!played) source->start(served);
  std::cerr << "serving on " << options.address << ":" << server.port() << "; Ctrl-C ends it\n";
  const double start_s = live_clock_s();
  const auto out_of_time = [&] { return command.seconds && live_clock_s() - start_s >= *command.seconds; };
  if (played) {
    wait_until_done(server, served, [&] { return server.counts().clients > 0 || out_of_time(); });
    source->start(served);
  }
  wait_until_done(server, served, [&] {
    const SourceState state = served.last().state;
    return out_of_time() || server.counts().frames == options.most_frames || state == SourceState::kEnded ||
           state == SourceState::kFailed;
  });
  source->stop();
  if (!was_interrupted()) server.flush(kFlush_s);
  if (::isatty(STDERR_FILENO) != 0) std::cerr << "\r\033[K";
  if (const SourceEvent last = served.last(); last.state == SourceState::kFailed) throw Error(last.message);
  return server.counts();
}

void run(const ServeCommand& command) {
  const auto counts = serve(command);
  if (command.json) {
    print_json({{"clients", counts.clients},
                {"frames", counts.frames},
                {"frames_sent", counts.frames_sent},
                {"dropped_frames", counts.dropped_frames}});
    return;
  }
  print_table({{"clients", std::to_string(counts.clients)},
               {"frames", std::to_string(counts.frames)},
               {"frames sent, to all clients", std::to_string(counts.frames_sent)},
               {"dropped for slow clients", std::to_string(counts.dropped_frames)}});
}

}  // namespace

void add_serve(CLI::App& app) {
  auto options = std::make_shared<ServeCommand>();
  CLI::App* command = app.add_subcommand("serve", "Stream a recording or a live source to OpenIGTLink clients");
  command
      ->add_option("SOURCE", options->source,
                   "A recording or an exam of one, played over and over; or a live source, see fathom devices")
      ->required();
  command->add_option("--port", options->server.port, "The port to wait for clients on; 0 is any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--bind", options->server.address,
                   "The address to wait on; 0.0.0.0 lets everybody in who can reach this computer")
      ->capture_default_str();
  command->add_option("--device", options->server.image_device, "What the images are called")->capture_default_str();
  command->add_option("--seconds", options->seconds, "End after this time (default: at Ctrl-C)")->check(above(0));
  command->add_option("--frames", options->frames, "End after so many frames were sent to anybody")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 53));
  command->add_flag("--once", options->once, "Play a recording only once");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
