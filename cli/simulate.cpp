#include "sim/simulate.h"

#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/atomic_file.h"
#include "registration/calibration.h"
#include "sim/phantom.h"
#include "sim/scan_plan.h"

namespace fathom {

namespace {

struct SimulateCommand {
  SimulateOptions scan;
  std::string out;
  bool json = false;
  bool speckle = false;
};

void run(const SimulateCommand& command) {
  const SimulatedScan scan = simulate(command.scan, progress_bar("outlining"));
  const std::filesystem::path out = command.out;
  std::filesystem::path stem = out;
  stem.replace_extension();
  // The small files are safe on disk before the recording gets its name: all four appear, or none.
  AtomicFile calibration(stem.string() + ".calibration.json");
  AtomicFile truth(stem.string() + ".truth.json");
  AtomicFile contours(stem.string() + ".contours.json");
  calibration.write(calibration_json(scan.calibration));
  truth.write(truth_json(scan, command.scan));
  contours.write(contours_json(scan.outlines));
  for (AtomicFile* file : {&calibration, &truth, &contours}) file->prepare();
  write_recording(*scan.recording, out, {}, progress_bar("scanning"));
  AtomicFile::commit_all({&calibration, &truth, &contours});

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

}  // namespace

void add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateCommand>();
  SimulateOptions& scan = options->scan;
  CLI::App* command = app.add_subcommand("simulate", "Scan a phantom of known volume");
  command->add_option("--object", scan.object, "What to scan")->required()->check(CLI::IsMember(object_names()));
  command->add_option("--pattern", scan.pattern, "How the probe moves")
      ->required()
      ->check(CLI::IsMember(pattern_names()));
  command->add_option("--frames", scan.frames, "Number of B-scans")
      ->required()
      ->check(CLI::Range(1, SimulateOptions::kMaxFrames));
  command
      ->add_option("--out", options->out,
                   "The recording to write; the truth, the calibration and the true outlines "
                   "go beside it")
      ->required();
  command->add_option("--seed", scan.seed, "Seed of all random numbers")->check(whole_number())->capture_default_str();
  command->add_option("--jitter-mm", scan.jitter_mm, "Unsteady hand: +- on each axis, before the scan")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  command->add_option("--jitter-deg", scan.jitter_deg, "The same for the three angles")
      ->check(between(0, SimulateOptions::kMaxTurn_deg));
  command->add_option("--misregister-mm", scan.misregister_mm, "Errors of the recorded positions: +- on each axis")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  command->add_option("--misregister-deg", scan.misregister_deg, "The same for the three angles")
      ->check(between(0, SimulateOptions::kMaxTurn_deg));
  command->add_option("--noise-mm", scan.noise_mm, "Tracker noise: rms distance")
      ->check(between(0, SimulateOptions::kMaxShift_mm));
  command->add_option("--noise-deg", scan.noise_deg, "Tracker noise: rms angle")
      ->check(between(0, SimulateOptions::kMaxTurn_deg));
  command->add_option("--latency-s", scan.latency_s, "How much the tracker's time stamps lag the image's")
      ->check(between(-SimulateOptions::kMaxLatency_s, SimulateOptions::kMaxLatency_s));
  command->add_flag("--speckle", options->speckle, "B-scans with speckle, as a scanner shows them");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] {
    if (options->speckle) options->scan.speckle.emplace();
    run(*options);
  });
}

}  // namespace fathom
