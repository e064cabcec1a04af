#include <algorithm>
#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/error.h"
#include "core/text_file.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

struct PlanesCommand {
  ScanInput input;
  std::vector<std::vector<double>> add;
  std::string out;
  bool keep = false;
  bool save = false;
  bool json = false;
};

void run(const PlanesCommand& options) {
  auto exam = read_if_exam(options.input.recording);
  if (options.save) require_exam_to_save(exam);
  if (options.keep && !exam) throw CLI::ValidationError("--keep", "RECORDING is no exam that has planes to keep");
  const Scan scan = open_scan(options.input, exam);
  const std::vector<Sweep> sweeps = exam && !exam->sweeps.empty() ? exam->sweeps : find_sweeps(scan);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < scan.recordings.size(); ++i) {
    if (std::any_of(sweeps.begin(), sweeps.end(), [i](const Sweep& sweep) { return sweep.recording == i; })) continue;
    warnings.push_back(scan.recordings[i]->name() +
                       ": has no sweep and is not used; `fathom sweeps` finds sweeps anew");
  }
  std::vector<SweepShape> shapes = sweep_shapes(sweeps, scan);
  SpacePartition partition = options.keep ? SpacePartition(std::move(shapes), exam->dividing_planes)
                                          : place_dividing_planes(std::move(shapes), &warnings);
  for (const std::vector<double>& plane : options.add) {
    const Eigen::Vector3d normal(plane[0], plane[1], plane[2]);
    const double length = normal.norm();
    if (!(length > 0.0)) throw Error("--add: the normal has no length; give a direction and an offset in mm");
    partition.add(DividingPlane(normal / length, -plane[3] / length));
  }
  for (std::size_t i = 0; i < partition.planes().size(); ++i) {
    if (!partition.separates(i)) warnings.push_back("plane " + std::to_string(i + 1) + " separates no sweeps");
  }
  const std::string text = planes_json({sweeps, partition.planes()});
  if (!options.out.empty()) write_text_file(options.out, text);
  if (options.save) {
    set_division(*exam, sweeps, partition.planes());
    write_exam(*exam);
  }
  if (options.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
    json.erase("fathom_planes");
    json["cells"] = nlohmann::ordered_json::array();
    for (const SpacePartition::Cell& cell : partition.cells()) {
      nlohmann::ordered_json sides = nlohmann::ordered_json::array();
      for (std::size_t i = 0; i < partition.planes().size(); ++i) sides.push_back((cell.sides >> i & 1u) != 0 ? 1 : -1);
      json["cells"].push_back(
          {{"sides", std::move(sides)},
           {"sweep", cell.sweep ? nlohmann::ordered_json(*cell.sweep) : nlohmann::ordered_json(nullptr)},
           {"region", cell.region}});
    }
    json["warnings"] = warnings;
    print_json(json);
    return;
  }
  if (partition.planes().empty()) {
    std::cout << "no dividing planes\n";
  } else {
    std::vector<std::vector<std::string>> rows{{"plane", "normal x", "y", "z", "offset, mm"}};
    for (std::size_t i = 0; i < partition.planes().size(); ++i) {
      const DividingPlane& plane = partition.planes()[i];
      rows.push_back({std::to_string(i + 1), number_text(plane.normal().x(), 4), number_text(plane.normal().y(), 4),
                      number_text(plane.normal().z(), 4), number_text(-plane.offset(), 2)});
    }
    print_table(rows);
  }
  std::cout << "sweeps: " << sweeps.size() << ", parts of space: " << partition.cells().size() << "\n";
  for (const std::string& warning : warnings) std::cout << "warning: " << warning << "\n";
}

}  // namespace

void add_planes(CLI::App& app) {
  auto options = std::make_shared<PlanesCommand>();
  CLI::App* command = app.add_subcommand("planes", "Place the planes that divide space between sweeps");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  add_number_lists(*command, "--add", options->add, 4, "nx,ny,nz,offset",
                   "One more plane: nx,ny,nz,offset (normal . x = offset, mm); may be repeated");
  command->add_option("--out", options->out, "Where to write the planes (JSON)");
  command->add_flag("--keep", options->keep, "Keep the exam's planes instead of placing them anew");
  command->add_flag("--save", options->save, "Write sweeps and planes into the exam");
  add_frame_names(*command, options->input.names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
