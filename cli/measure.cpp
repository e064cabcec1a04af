#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "exam/results.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

struct MeasureCommand {
  std::string recording;
  std::string calibration;
  std::string contours;
  FrameNames names;
  bool no_surfaces = false;
  bool json = false;
};

void run(const MeasureCommand& options) {
  const auto recording = open_recording(options.recording);
  const Calibration calibration = read_calibration(options.calibration, options.names.probe);
  const std::vector<Structure> structures = read_contours(options.contours);
  require_measurable(structures, recording->header().frame_count(), options.contours);
  require_simple_outlines(structures, options.contours);
  const FrameLocator locator(*recording, calibration, options.names);
  const std::vector<StructureResult> results = measure_structures(
      structures, *recording, locator, {.surfaces = !options.no_surfaces}, progress_bar("measuring"));
  if (options.json) {
    print_json(results_json(results));
  } else {
    print_results(results);
  }
}

}  // namespace

void add_measure(CLI::App& app) {
  auto options = std::make_shared<MeasureCommand>();
  CLI::App* command = app.add_subcommand("measure", "Give the volume of every outlined structure by every method");
  command->add_option("RECORDING", options->recording, "A .mha, .mhd or .nrrd sequence")->required();
  command->add_option("--calibration", options->calibration, "Fathom's JSON, or a PLUS XML")->required();
  command->add_option("--contours", options->contours, "The contours file")->required();
  add_frame_names(*command, options->names);
  command->add_flag("--no-surfaces", options->no_surfaces, "Planimetry only: at once, however many sections");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
