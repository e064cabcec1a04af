#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

struct SweepsCommand {
  std::string recording;
  std::string calibration;
  FrameNames names;
  FindSweepsOptions find;
  bool json = false;
};

void run(const SweepsCommand& options) {
  const auto recording = open_recording(options.recording);
  // Without a calibration the probe's own path is followed: enough to see where it jumps.
  const Calibration calibration =
      options.calibration.empty() ? Calibration{} : read_calibration(options.calibration, options.names.probe);
  const FrameLocator locator(*recording, calibration, options.names);
  const std::vector<Sweep> sweeps = find_sweeps(*recording, locator, options.find);
  if (sweeps.empty()) throw Error(options.recording + ": has no sweep, as no run of frames is valid; record again");
  if (options.json) {
    nlohmann::ordered_json json;
    json["sweeps"] = nlohmann::ordered_json::array();
    for (const Sweep& sweep : sweeps) {
      json["sweeps"].push_back({{"recording", sweep.recording}, {"first", sweep.first}, {"last", sweep.last}});
    }
    print_json(json);
    return;
  }
  std::vector<std::vector<std::string>> rows{{"sweep", "first", "last", "frames"}};
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    rows.push_back({std::to_string(i + 1), std::to_string(sweeps[i].first), std::to_string(sweeps[i].last),
                    std::to_string(frame_count(sweeps[i]))});
  }
  print_table(rows);
}

}  // namespace

void add_sweeps(CLI::App& app) {
  auto options = std::make_shared<SweepsCommand>();
  CLI::App* command = app.add_subcommand("sweeps", "Find the sweeps of a recording");
  command->add_option("RECORDING", options->recording, "A .mha, .mhd or .nrrd sequence")->required();
  command->add_option("--calibration", options->calibration, "Fathom's JSON, or a PLUS XML");
  command->add_option("--pause-s", options->find.pause_s, "A longer pause separates sweeps")
      ->check(above(0))
      ->capture_default_str();
  command->add_option("--jump-mm", options->find.jump_mm, "A farther jump between frames separates sweeps")
      ->check(above(0))
      ->capture_default_str();
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
