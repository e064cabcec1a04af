#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/mesh_output.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/atomic_file.h"
#include "measurement/contour_surface.h"
#include "segmentation/outline_topology.h"
#include "surface/mesh_file.h"

namespace fathom {

namespace {

struct SurfaceCommand {
  std::string recording;
  std::string calibration;
  std::string contours;
  std::string out;
  std::string structure;
  ContourSurfaceOptions surface;
  FrameNames names;
  bool json = false;
};

const std::map<std::string, Guide>& guides() {
  static const std::map<std::string, Guide> by_name = {
      {"disc", Guide::kDiscs}, {"shape", Guide::kShape}, {"centroid", Guide::kCentroids}};
  return by_name;
}

const std::map<std::string, GapOrder>& orders() {
  static const std::map<std::string, GapOrder> by_name = {{"linear", GapOrder::kLinear}, {"curved", GapOrder::kCurved}};
  return by_name;
}

std::vector<Structure> chosen_structures(const SurfaceCommand& command) {
  std::vector<Structure> structures = read_contours(command.contours);
  if (structures.empty()) throw Error(command.contours + ": holds no structure; outline one first");
  if (command.structure.empty()) return structures;
  std::string names;
  for (const Structure& structure : structures) {
    if (structure.name == command.structure) return {structure};
    names += (names.empty() ? "" : ", ") + structure.name;
  }
  throw Error(command.contours + ": has no structure '" + command.structure + "'; it has " + names);
}

// One mesh goes to the file itself, several to files that bear the structures' names before the extension.
std::vector<std::filesystem::path> files_for(const SurfaceCommand& command, const std::vector<Structure>& structures) {
  const std::filesystem::path out = command.out;
  if (structures.size() == 1) return {out};
  std::vector<std::filesystem::path> files;
  std::set<std::string> used;
  for (const Structure& structure : structures) {
    std::string name = structure.name;
    for (char& c : name) {
      if (c == '/' || c == '\\') c = '_';
    }
    if (!used.insert(name).second) {
      throw Error(command.contours + ": two structures would both be written to the file of '" + name +
                  "'; rename one, or choose one by --structure");
    }
    std::filesystem::path file = out;
    file.replace_filename(out.stem().string() + "." + name + out.extension().string());
    files.push_back(file);
  }
  return files;
}

MeshReport make_surface(const SurfaceCommand& command, const Structure& structure, const FrameLocator& locator,
                        AtomicFile& file, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  ContourSurface surface(locator, command.surface);
  const Mesh& mesh = surface.update(structure, part_of(progress, 0.0, 0.9));
  MeshWriteOptions options;
  const unsigned long rgb = std::stoul(structure.color.substr(1), nullptr, 16);
  options.color = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 0xff),
                   static_cast<std::uint8_t>(rgb & 0xff)};
  write_mesh(mesh, file, options, part_of(progress, 0.9, 1.0));
  MeshReport report = report_of(mesh, "a surface through contours is always closed: please report this");
  // Planimetry refuses sweeps in which a volume has no meaning.
  report.volume_ml = surface.volume_ml();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.warnings.insert(report.warnings.begin(), surface.warnings().begin(), surface.warnings().end());
  if (!report.volume_ml) {
    report.warnings.push_back("the sweep has no volume; `fathom measure` says why");
  }
  if (!mesh.sweep_signs.empty() && !keeps_sweep_signs(file.target())) {
    report.warnings.push_back(
        "regions that the sweep passed backward are marked in .ply files only; a program that "
        "reads " +
        file.target().filename().string() + " would measure too much");
  }
  return report;
}

void run(SurfaceCommand command) {
  command.surface.check();
  require_mesh_name(command.out);
  const auto exam = read_if_exam(command.recording);
  const ScanInput input{command.recording, command.calibration, command.contours, {}, command.names};
  command.contours = contours_file(input, exam);
  const std::string calibration_name = calibration_file(input, exam);
  const auto recording = open_only_recording(command.recording, "surface");
  const Calibration calibration = read_calibration(calibration_name, command.names.probe);
  const std::vector<Structure> structures = chosen_structures(command);
  require_measurable(structures, recording->header().frame_count(), command.contours);
  require_simple_outlines(structures, command.contours);
  const FrameLocator locator(*recording, calibration, command.names);
  const std::vector<std::filesystem::path> paths = files_for(command, structures);

  const Progress progress = progress_bar("making the surface");
  std::vector<std::unique_ptr<AtomicFile>> files;
  std::vector<AtomicFile*> to_commit;
  std::vector<MeshReport> reports;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    const double step = 1.0 / static_cast<double>(structures.size());
    const double done = step * static_cast<double>(i);
    files.push_back(std::make_unique<AtomicFile>(paths[i]));
    to_commit.push_back(files.back().get());
    reports.push_back(
        make_surface(command, structures[i], locator, *files.back(), part_of(progress, done, done + step)));
  }
  AtomicFile::commit_all(to_commit);
  report(progress, 1.0);

  if (!command.json) {
    for (std::size_t i = 0; i < structures.size(); ++i) {
      if (structures.size() > 1) std::cout << (i > 0 ? "\n" : "") << structures[i].name << "\n";
      print_mesh_report(reports[i], paths[i].string(), false);
    }
    return;
  }
  std::vector<nlohmann::ordered_json> items;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    nlohmann::ordered_json item = {{"name", structures[i].name}, {"out", paths[i].string()}};
    item.update(mesh_report_json(reports[i]));
    items.push_back(std::move(item));
  }
  print_json(items.size() == 1 ? items.front() : nlohmann::ordered_json{{"structures", items}});
}

}  // namespace

void add_surface(CLI::App& app) {
  auto options = std::make_shared<SurfaceCommand>();
  CLI::App* command = app.add_subcommand("surface", "Make the surface of outlined structures as a triangle mesh");
  add_recording(*command, options->recording);
  command->add_option("--calibration", options->calibration, "Fathom's JSON, or a PLUS XML (default: the exam's)");
  command->add_option("--contours", options->contours, "The contours file (default: the exam's)");
  command
      ->add_option(
          "--out", options->out,
          "The mesh to write: .ply, .stl, .obj, .off or .wrl; of several structures, with their names before the "
          "extension")
      ->required();
  command->add_option("--structure", options->structure, "Only this structure");
  command
      ->add_option("--method", options->surface.guide,
                   "What guides the interpolation between outlines: disc, shape or centroid")
      ->transform(CLI::CheckedTransformer(guides()).description("disc|shape|centroid"))
      ->default_str("disc");
  command
      ->add_option("--order", options->surface.order,
                   "linear: between two outlines; curved: by those beyond them as well, for round structures on few "
                   "frames")
      ->transform(CLI::CheckedTransformer(orders()).description("linear|curved"))
      ->default_str("linear");
  add_mesher_options(*command, options->surface.mesher);
  command
      ->add_option("--spacing-mm", options->surface.spacing_mm,
                   "Size of the lattice; an eightieth of the structure's extent by default")
      ->check(above(0.0));
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
