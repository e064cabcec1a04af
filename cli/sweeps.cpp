#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

struct SweepsCommand {
  ScanInput input;
  bool save = false;
  FindSweepsOptions find;
  bool json = false;
};

void run(const SweepsCommand& options) {
  const ScanInput& input = options.input;
  auto exam = read_if_exam(input.recording);
  if (options.save) require_exam_to_save(exam);
  // Without a calibration the path of the probe's own origin is followed: enough to see where it jumps.
  const bool placed = !input.calibration.empty() || (exam && !exam->calibration.empty());
  const Scan scan = placed ? open_scan(input, exam)
                    : exam ? open_scan(*exam, {}, input.names)
                           : open_scan(input.recording, {}, input.names);
  FindSweepsOptions find = options.find;
  if (!placed) find.follow_px = Eigen::Vector2d::Zero();
  const std::vector<Sweep> sweeps = find_sweeps(scan, find);
  if (options.save) {
    set_division(*exam, sweeps, exam->dividing_planes);
    write_exam(*exam);
  }
  if (options.json) {
    nlohmann::ordered_json json;
    json["sweeps"] = nlohmann::ordered_json::array();
    for (const Sweep& sweep : sweeps) {
      json["sweeps"].push_back({{"recording", sweep.recording}, {"first", sweep.first}, {"last", sweep.last}});
    }
    print_json(json);
    return;
  }
  std::vector<std::vector<std::string>> rows{{"sweep", "recording", "first", "last", "frames"}};
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    rows.push_back({std::to_string(i + 1), std::to_string(sweeps[i].recording), std::to_string(sweeps[i].first),
                    std::to_string(sweeps[i].last), std::to_string(frame_count(sweeps[i]))});
  }
  print_table(rows);
}

}  // namespace

void add_sweeps(CLI::App& app) {
  auto options = std::make_shared<SweepsCommand>();
  CLI::App* command = app.add_subcommand("sweeps", "Find the sweeps of a recording");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  command->add_option("--pause-s", options->find.pause_s, "A longer pause separates sweeps")
      ->check(above(0))
      ->capture_default_str();
  command->add_option("--jump-mm", options->find.jump_mm, "A farther jump between frames separates sweeps")
      ->check(above(0))
      ->capture_default_str();
  add_frame_names(*command, options->input.names);
  command->add_flag("--save", options->save, "Write the sweeps into the exam");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
