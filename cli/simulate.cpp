#include "sim/simulate.h"

#include <algorithm>
#include <iostream>
#include <list>
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/atomic_file.h"
#include "registration/calibration.h"
#include "registration/wire_phantom_file.h"
#include "sim/phantom.h"
#include "sim/scan_plan.h"
#include "sim/target_scan.h"

namespace fathom {

namespace {

struct SimulateCommand {
  SimulateOptions scan;
  std::string out;
  std::string phantom;
  std::string probe = "linear";
  double away_mm = 0.0;
  bool json = false;
  bool speckle = false;
};

/// The recording and the small files that go beside it: text by the end of its name.
void write_scan(const Recording& recording, const std::filesystem::path& out,
                const std::vector<std::pair<std::string, std::string>>& texts) {
  std::filesystem::path stem = out;
  stem.replace_extension();
  // The small files are safe on disk before the recording gets its name: all appear, or none.
  std::list<AtomicFile> files;
  std::vector<AtomicFile*> all;
  for (const auto& [ending, text] : texts) {
    AtomicFile& file = files.emplace_back(stem.string() + ending);
    file.write(text);
    file.prepare();
    all.push_back(&file);
  }
  write_recording(recording, out, {}, progress_bar("scanning"));
  AtomicFile::commit_all(all);
}

void run_target(const SimulateCommand& command) {
  TargetScanOptions options;
  static_cast<TrackerOptions&>(options) = command.scan;
  options.object = command.scan.object;
  options.pattern = command.scan.pattern;
  options.frames = command.scan.frames;
  options.probe = command.probe;
  options.away_mm = command.away_mm;
  if (!command.phantom.empty()) options.phantom = read_wire_phantom(command.phantom);
  const SimulatedTargetScan scan = simulate_target(options);
  write_scan(*scan.recording, command.out,
             {{".calibration.json", calibration_json(scan.calibration)}, {".truth.json", truth_json(scan, options)}});
  if (command.json) {
    print_json({{"frames", options.frames}, {"frames_in_view", scan.frames_in_view}});
    return;
  }
  std::cout << "scanned " << options.object << " with " << options.frames << " frames, " << options.pattern << ", to "
            << command.out << "; " << scan.frames_in_view << " of them show all of it\n";
}

void run(const SimulateCommand& command) {
  const SimulatedScan scan = simulate(command.scan, progress_bar("outlining"));
  write_scan(*scan.recording, command.out,
             {{".calibration.json", calibration_json(scan.calibration)},
              {".truth.json", truth_json(scan, command.scan)},
              {".contours.json", contours_json(scan.outlines)}});

  if (command.json) {
    nlohmann::ordered_json json;
    json["volume_ml"] = scan.truth.volume_ml;
    json["surface_area_cm2"] = scan.truth.surface_area_cm2;
    json["structures"] = nlohmann::ordered_json::array();
    for (const auto& structure : scan.truth.structures) {
      json["structures"].push_back({{"name", structure.name}, {"volume_ml", structure.volume_ml}});
    }
    print_json(json);
    return;
  }
  std::cout << "scanned " << command.scan.object << " with " << scan.recording->header().frame_count() << " frames, "
            << command.scan.pattern << ", to " << command.out << "\n";
  for (const auto& structure : scan.truth.structures) {
    std::cout << "true volume of " << structure.name << ": " << number_text(structure.volume_ml, 4) << " ml\n";
  }
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> joined(std::vector<std::string> names, const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

/// Options that do not go with the object are a wrong command line, not ignored.
void require_together(const SimulateCommand& command, bool target, const CLI::App& solids, const CLI::App& targets) {
  const std::string& object = command.scan.object;
  if (!contains(target ? target_pattern_names() : pattern_names(), command.scan.pattern)) {
    throw CLI::ValidationError("--pattern", command.scan.pattern + " does not go with --object " + object);
  }
  for (const CLI::Option* option : (target ? solids : targets).get_options()) {
    if (!option->empty()) throw CLI::ValidationError(option->get_name(), "does not go with --object " + object);
  }
  if ((object == "wires") == command.phantom.empty()) {
    throw CLI::ValidationError("--phantom",
                               "says where the wires are: it goes with --object wires, and is needed there");
  }
}

void add_tracker_errors(CLI::App& command, TrackerOptions& tracker) {
  command.add_option("--noise-mm", tracker.noise_mm, "Tracker noise: rms distance")
      ->check(between(0, TrackerOptions::kMaxShift_mm));
  command.add_option("--noise-deg", tracker.noise_deg, "Tracker noise: rms angle")
      ->check(between(0, TrackerOptions::kMaxTurn_deg));
  command.add_option("--latency-s", tracker.latency_s, "How much the tracker's time stamps lag the image's")
      ->check(between(-TrackerOptions::kMaxLatency_s, TrackerOptions::kMaxLatency_s));
  command.add_option("--outliers", tracker.outliers, "Share of the poses that are wrong, but marked valid")
      ->check(between(0, 1));
  command.add_option("--dropouts", tracker.dropouts, "Share of the poses that are lost, marked invalid")
      ->check(between(0, 1));
}

}  // namespace

void add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateCommand>();
  SimulateOptions& scan = options->scan;
  CLI::App* command = app.add_subcommand(
      "simulate", "Scan a phantom of known volume, or what a probe is calibrated with in a water bath");
  command->add_option("--object", scan.object, "What to scan; \"wires\", \"wall\" and \"point\" are for calibration")
      ->required()
      ->check(CLI::IsMember(joined(object_names(), target_names())));
  command
      ->add_option(
          "--pattern", scan.pattern,
          "How the probe moves; over what is for calibration: \"calibrate\", \"floor\" (up and down) or \"still\"")
      ->required()
      ->check(CLI::IsMember(joined(pattern_names(), target_pattern_names())));
  command->add_option("--frames", scan.frames, "Number of B-scans")
      ->required()
      ->check(CLI::Range(1, SimulateOptions::kMaxFrames));
  command
      ->add_option("--out", options->out,
                   "The recording to write; the truth, the calibration and the true outlines "
                   "go beside it")
      ->required();
  command->add_option("--seed", scan.seed, "Seed of all random numbers")->check(whole_number())->capture_default_str();
  CLI::App* solids = command->add_option_group("objects of known volume");
  solids->add_option("--jitter-mm", scan.jitter_mm, "Unsteady hand: +- on each axis, before the scan")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  solids->add_option("--jitter-deg", scan.jitter_deg, "The same for the three angles")
      ->check(between(0, SimulateOptions::kMaxTurn_deg));
  solids->add_option("--misregister-mm", scan.misregister_mm, "Errors of the recorded positions: +- on each axis")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  solids->add_option("--misregister-deg", scan.misregister_deg, "The same for the three angles")
      ->check(between(0, SimulateOptions::kMaxTurn_deg));
  solids->add_flag("--speckle", options->speckle, "B-scans with speckle, as a scanner shows them");
  CLI::App* targets = command->add_option_group("for calibration");
  targets->add_option("--phantom", options->phantom, "Wires: where they are, a PLUS XML or Fathom's JSON");
  targets->add_option("--probe", options->probe, "Its images: a rectangle or a fan")
      ->check(CLI::IsMember(probe_names()))
      ->capture_default_str();
  targets->add_option("--away-mm", options->away_mm, "The probe is held so much farther from the target")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  add_tracker_errors(*command, scan);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, solids, targets] {
    const bool target = contains(target_names(), options->scan.object);
    require_together(*options, target, *solids, *targets);
    if (options->speckle) options->scan.speckle.emplace();
    (target ? run_target : run)(*options);
  });
}

}  // namespace fathom
