#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "exam/results.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

struct MeasureCommand {
  ScanInput input;
  MeasurementErrors errors;
  bool no_surfaces = false;
  bool save = false;
  bool json = false;
};

std::vector<StructureResult> measure(const MeasureCommand& command, const std::optional<Exam>& exam) {
  const std::string file = contours_file(command.input, exam);
  const Scan scan = open_scan(command.input, exam);
  const std::vector<Structure> structures = read_contours(file);
  // Whether outlines may be open depends on the planes, which depend on where outlines are.
  require_measurable(structures, frame_counts(scan), OpenContours::kAllow, file);
  require_simple_outlines(structures, file);
  MeasureOptions options{.surfaces = !command.no_surfaces};
  command.errors.check();
  const bool may_divide = exam || !command.input.planes.empty();
  if (!may_divide) require_measurable(structures, frame_counts(scan), OpenContours::kRefuse, file);
  const auto division = division_of(command.input, exam, scan, structures);
  const bool divided = division && !division->partition.planes().empty();
  if (!divided) require_measurable(structures, frame_counts(scan), OpenContours::kRefuse, file);
  options.confidence = {scan.calibration, scan.names, command.errors};
  if (division) return measure_structures(structures, scan, *division, options, progress_bar("measuring"));
  return measure_structures(structures, *scan.recordings.front(), scan.locators.front(), options,
                            progress_bar("measuring"));
}

void run(const MeasureCommand& command) {
  auto exam = read_if_exam(command.input.recording);
  if (command.save) require_exam_to_save(exam);
  const ScanInput& input = command.input;
  if (command.save && !(input.calibration.empty() && input.contours.empty() && input.planes.empty())) {
    throw CLI::ValidationError("--save",
                               "keeps what is measured with the exam's own files; put them in by `fathom exam "
                               "update`, or leave out --calibration, --contours and --planes");
  }
  const std::vector<StructureResult> results = measure(command, exam);
  const nlohmann::ordered_json json = results_json(results);
  if (command.save) {
    exam->results = nlohmann::json::parse(json.dump());
    write_exam(*exam);
  }
  if (command.json) {
    print_json(json);
  } else {
    print_results(results);
  }
}

}  // namespace

void add_measure(CLI::App& app) {
  auto options = std::make_shared<MeasureCommand>();
  CLI::App* command = app.add_subcommand("measure", "Give the volume of every outlined structure by every method");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  add_contours(*command, options->input);
  command->add_option("--planes", options->input.planes,
                      "Sweeps and dividing planes, as `fathom planes` writes them (default: the exam's)");
  add_frame_names(*command, options->input.names);
  command->add_option("--outline-sd-mm", options->errors.outline_mm,
                      "How far outlines are off by chance, standard deviation in mm, for the interval (default: judged "
                      "from how unevenly the sections follow each other)");
  command->add_option("--tracker-sd-mm", options->errors.tracker_mm,
                      "Noise of the probe's position, root mean square in space in mm, for the interval");
  command->add_option("--tracker-sd-deg", options->errors.tracker_deg,
                      "Noise of its orientation, root mean square in space in degrees");
  command->add_flag("--no-surfaces", options->no_surfaces, "Planimetry only: at once, however many sections");
  command->add_flag("--save", options->save, "Write the results into the exam");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
