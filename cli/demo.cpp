#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/output.h"
#include "core/staged_folder.h"
#include "core/text_file.h"
#include "exam/make_exam.h"
#include "exam/report_picture.h"
#include "exam/results.h"
#include "exam/surface_picture.h"
#include "measurement/contour_surface.h"
#include "segmentation/threshold_recording.h"
#include "sim/simulate.h"
#include "surface/mesh_file.h"

namespace fathom {

namespace {

constexpr int kOutlineEvery = 10;

struct DemoOptions {
  std::string out = "fathom-demo";
  bool json = false;
};

// A simulated patient: an organ of known volume, swept by a free hand, with a tracker's usual noise.
SimulateOptions patient() {
  SimulateOptions options;
  options.object = "kidney";
  options.pattern = "free";
  options.frames = 201;
  options.jitter_mm = 0.3;
  options.jitter_deg = 0.5;
  options.noise_mm = 0.25;
  options.noise_deg = 0.15;
  return options;
}

int middle_outlined_frame(const Structure& structure) {
  return structure.contours[structure.contours.size() / 2].frame;
}

void run(const DemoOptions& options) {
  StagedFolder staged(options.out);
  const std::filesystem::path& folder = staged.path();
  const SimulateOptions scan_options = patient();
  const SimulatedScan scan = simulate(scan_options);
  write_text_file(folder / "calibration.json", calibration_json(scan.calibration));
  write_text_file(folder / "truth.json", truth_json(scan, scan_options));
  write_recording(*scan.recording, folder / "recording.mha", {}, progress_bar("scanning"));

  // From here on the demo knows no more than an examiner would: what was recorded, and the calibration.
  const auto recording = open_recording(folder / "recording.mha");
  const Calibration calibration = read_calibration(folder / "calibration.json");
  ThresholdRecordingOptions segment;
  segment.structure = scan.truth.structures.front().name;
  segment.every = kOutlineEvery;
  segment.ends = true;
  const Structure outlined = segment_by_threshold(*recording, segment, progress_bar("outlining"));
  write_text_file(folder / "contours.json", contours_json({outlined}));

  const FrameLocator locator(*recording, calibration);
  const std::vector<StructureResult> results =
      measure_structures({outlined}, *recording, locator, {.confidence = ConfidenceOptions{calibration, {}, {}}},
                         progress_bar("measuring"));
  const nlohmann::ordered_json json = results_json(results);
  write_text_file(folder / "results.json", json.dump(1, ' ') + "\n");

  const double truth = scan.truth.structures.front().volume_ml;
  const auto measured = results.front().measurement.volumes.recommended_ml();
  std::string verdict = "true volume " + number_text(truth, 2) + " ml";
  if (measured) {
    verdict += ", measured " + number_text(*measured, 2) + " ml by " + kRecommendedMethod + " (" +
               number_text(100.0 * (*measured / truth - 1.0), 2) + " %)";
  }
  const std::string sections = results.front().name + ": " + std::to_string(results.front().measurement.sections) +
                               " cross-sections outlined on " + std::to_string(recording->header().frame_count()) +
                               " frames of a simulated free-hand sweep";
  write_png(report_picture(*recording, locator, {outlined}, middle_outlined_frame(outlined), {sections, verdict}),
            folder / "report.png");

  ContourSurface surface(locator, {});
  surface.update(outlined, progress_bar("making the surface"));
  write_mesh(surface.mesh(), folder / "surface.ply");
  const std::string through = results.front().name + ": surface through the outlines, " +
                              std::to_string(surface.mesh().triangles.size()) + " triangles, " +
                              number_text(surface.volume_ml(), 2) + " ml";
  write_png(surface_picture({surface.mesh()}, locator, {outlined}, {through}), folder / "surface.png");

  ExamParts parts;
  parts.recordings = {folder / "recording.mha"};
  parts.calibration = folder / "calibration.json";
  parts.contours = folder / "contours.json";
  parts.patient = "simulated patient";
  create_exam(folder, parts);

  staged.commit("exam.json");

  if (options.json) {
    print_json(json);
    return;
  }
  print_results(results);
  std::cout << "\n" << verdict << "\n";
  std::cout << "written to " << options.out << ": recording.mha, calibration.json, truth.json, contours.json, "
            << "results.json, report.png, surface.ply, surface.png, exam.json\n";
}

}  // namespace

void add_demo(CLI::App& app) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command =
      app.add_subcommand("demo", "Measure an organ of a simulated patient, from scan to report, without any device");
  command->add_option("--out", options->out, "Folder to write to")->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
