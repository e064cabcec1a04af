#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/mesh_output.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/atomic_file.h"
#include "exam/structure_files.h"
#include "measurement/contour_surface.h"
#include "measurement/partition_surface.h"
#include "measurement/partition_volume.h"
#include "measurement/section_outline.h"
#include "segmentation/outline_topology.h"
#include "surface/mesh_file.h"

namespace fathom {

namespace {

struct SurfaceCommand {
  ScanInput input;
  std::string out;
  std::string structure;
  bool open = false;
  ContourSurfaceOptions surface;
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

std::vector<Structure> chosen_structures(const SurfaceCommand& command, const std::string& contours) {
  std::vector<Structure> structures = read_contours(contours);
  if (structures.empty()) throw Error(contours + ": holds no structure; outline one first");
  if (command.structure.empty()) return structures;
  std::string names;
  for (const Structure& structure : structures) {
    if (structure.name == command.structure) return {structure};
    names += (names.empty() ? "" : ", ") + structure.name;
  }
  throw Error(contours + ": has no structure '" + command.structure + "'; it has " + names);
}

// What was made of one structure.
struct Made {
  MeshReport mesh;
  std::optional<PartitionedSurface> parts;  // over several sweeps
};

void add_warnings(const std::vector<std::string>& of_surface, const Mesh& mesh, const AtomicFile& file,
                  MeshReport& report) {
  report.warnings.insert(report.warnings.begin(), of_surface.begin(), of_surface.end());
  if (!mesh.sweep_signs.empty() && !keeps_sweep_signs(file.target())) {
    report.warnings.push_back(
        "regions that the sweep passed backward are marked in .ply files only; a program that "
        "reads " +
        file.target().filename().string() + " would measure too much");
  }
}

// Why a surface through the outlines of several sweeps has no volume; empty where one has all of them.
std::string several_sweeps(const Structure& structure, const std::vector<Sweep>& sweeps) {
  const auto outlined = std::count_if(sweeps.begin(), sweeps.end(), [&](const Sweep& sweep) {
    return !part_in_sweep(structure, sweep).contours.empty();
  });
  if (outlined < 2) return {};
  return "outlined in " + std::to_string(outlined) +
         " sweeps with no dividing planes: this surface runs through them one after another and has no volume, as "
         "they may show the same part twice; place planes (fathom planes), or outline one sweep";
}

Made make_surface(const SurfaceCommand& command, const Structure& structure, const FrameLocator& locator,
                  const std::optional<Division>& division, AtomicFile& file, const Progress& progress) {
  ContourSurface surface(locator, command.surface);
  const Mesh& mesh = surface.update(structure, part_of(progress, 0.0, 0.9));
  write_structure_mesh(mesh, structure, file, part_of(progress, 0.9, 1.0));
  MeshReport report = report_of(mesh, "a surface through contours is always closed: please report this");
  // Planimetry refuses sweeps in which a volume has no meaning.
  report.volume_ml = surface.volume_ml();
  add_warnings(surface.warnings(), mesh, file, report);
  const std::string several = division ? several_sweeps(structure, division->sweeps) : std::string();
  if (!several.empty()) {
    report.volume_ml.reset();
    report.warnings.push_back(several);
  } else if (!report.volume_ml) {
    report.warnings.push_back("the sweep has no volume; `fathom measure` says why");
  }
  return {std::move(report), {}};
}

Made make_parts(const SurfaceCommand& command, const Structure& structure, const Scan& scan, const Division& division,
                AtomicFile& file, const Progress& progress) {
  const Caps caps = command.open ? Caps::kOpen : Caps::kClosed;
  PartitionedSurface surface =
      partition_surface(structure, scan.locators, division, command.surface, caps, part_of(progress, 0.0, 0.9));
  const Mesh mesh = surface.mesh();
  write_structure_mesh(mesh, structure, file, part_of(progress, 0.9, 1.0));
  MeshReport report = report_of(mesh, "leave out --open");
  if (command.open) report.warnings.clear();  // as was asked for
  report.volume_ml = surface.volume_ml;
  report.area_cm2 = surface.surface_area_mm2() / 100.0;
  if (auto unused = unused_outlines_warning(structure, division.sweeps)) {
    surface.warnings.insert(surface.warnings.begin(), std::move(*unused));
  }
  add_warnings(surface.warnings, mesh, file, report);
  return {std::move(report), std::move(surface)};
}

nlohmann::ordered_json parts_json(const PartitionedSurface& surface) {
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  for (const PartSurface& part : surface.parts) {
    nlohmann::ordered_json item = {{"sweep", part.sweep},
                                   {"region", part.region},
                                   {"planes", part.planes},
                                   {"triangles", part.surface.mesh.triangles.size()}};
    item["volume_ml"] = part.volume_ml ? nlohmann::ordered_json(*part.volume_ml) : nlohmann::ordered_json();
    if (!part.volume_ml) item["no_volume"] = part.no_volume;
    parts.push_back(std::move(item));
  }
  nlohmann::ordered_json cuts = nlohmann::ordered_json::array();
  for (const PlaneMatch& match : surface.planes) {
    cuts.push_back({{"plane", match.plane},
                    {"above_mm2", match.above_mm2},
                    {"below_mm2", match.below_mm2},
                    {"mismatch_mm2", match.mismatch_mm2}});
  }
  return {{"partitions", std::move(parts)}, {"cuts", std::move(cuts)}};
}

void print_parts(const PartitionedSurface& surface) {
  std::vector<std::vector<std::string>> rows{{"sweep", "planes", "triangles", "volume (ml)"}};
  for (const PartSurface& part : surface.parts) {
    std::string planes;
    for (const std::size_t plane : part.planes) planes += (planes.empty() ? "" : ",") + std::to_string(plane + 1);
    rows.push_back({std::to_string(part.sweep + 1), planes.empty() ? "-" : planes,
                    std::to_string(part.surface.mesh.triangles.size()), number_text(part.volume_ml, 4)});
  }
  print_table(rows);
  for (const PartSurface& part : surface.parts) {
    if (!part.volume_ml) std::cout << "no volume in sweep " << part.sweep + 1 << ": " << part.no_volume << "\n";
  }
}

// Whether the surface is made of parts: where planes divide space, or where they should, as there are several
// recordings or the sweeps that were typed are several.
bool is_divided(const SurfaceCommand& command, const std::optional<Division>& division, const Scan& scan) {
  if (!division) return false;
  const bool several = !command.input.planes.empty() && division->sweeps.size() > 1;
  return several || scan.recordings.size() > 1 || !division->partition.planes().empty();
}

void run(const SurfaceCommand& command) {
  command.surface.check();
  require_mesh_name(command.out);
  const auto exam = read_if_exam(command.input.recording);
  const std::string contours = contours_file(command.input, exam);
  const Scan scan = open_scan(command.input, exam);
  const std::vector<Structure> structures = chosen_structures(command, contours);
  const std::optional<Division> division = division_of(command.input, exam, scan, structures);
  const bool divided = is_divided(command, division, scan);
  if (command.open && !divided) throw CLI::ValidationError("--open", "needs dividing planes: --planes, or an exam's");
  require_measurable(structures, frame_counts(scan), divided ? OpenContours::kAllow : OpenContours::kRefuse, contours);
  require_simple_outlines(structures, contours);
  const std::vector<std::filesystem::path> paths = structure_files(command.out, structures);

  const Progress progress = progress_bar("making the surface");
  std::vector<std::unique_ptr<AtomicFile>> files;
  std::vector<AtomicFile*> to_commit;
  std::vector<Made> made;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    const double step = 1.0 / static_cast<double>(structures.size());
    const double done = step * static_cast<double>(i);
    files.push_back(std::make_unique<AtomicFile>(paths[i]));
    to_commit.push_back(files.back().get());
    const Progress here = part_of(progress, done, done + step);
    const auto start = std::chrono::steady_clock::now();
    made.push_back(divided
                       ? make_parts(command, structures[i], scan, *division, *files.back(), here)
                       : make_surface(command, structures[i], scan.locators.front(), division, *files.back(), here));
    made.back().mesh.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  AtomicFile::commit_all(to_commit);
  report(progress, 1.0);

  if (!command.json) {
    for (std::size_t i = 0; i < structures.size(); ++i) {
      if (structures.size() > 1) std::cout << (i > 0 ? "\n" : "") << structures[i].name << "\n";
      if (made[i].parts) print_parts(*made[i].parts);
      print_mesh_report(made[i].mesh, paths[i].string(), false);
    }
    return;
  }
  std::vector<nlohmann::ordered_json> items;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    nlohmann::ordered_json item = {{"name", structures[i].name}, {"out", paths[i].string()}};
    item.update(mesh_report_json(made[i].mesh));
    if (made[i].parts) item.update(parts_json(*made[i].parts));
    items.push_back(std::move(item));
  }
  print_json(items.size() == 1 ? items.front() : nlohmann::ordered_json{{"structures", items}});
}

}  // namespace

void add_surface(CLI::App& app) {
  auto options = std::make_shared<SurfaceCommand>();
  CLI::App* command = app.add_subcommand("surface", "Make the surface of outlined structures as a triangle mesh");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  add_contours(*command, options->input);
  command
      ->add_option(
          "--out", options->out,
          "The mesh to write: .ply, .stl, .obj, .off or .wrl; of several structures, with their names before the "
          "extension")
      ->required();
  command->add_option("--structure", options->structure, "Only this structure");
  command->add_option(
      "--planes", options->input.planes,
      "What `fathom planes` wrote: each part of space is taken from its own sweep (default: the exam's)");
  command->add_flag("--open", options->open, "Leave the parts open where dividing planes cut them");
  command
      ->add_option("--method", options->surface.guide,
                   "What guides the interpolation between outlines: disc, shape or centroid")
      ->transform(CLI::CheckedTransformer(guides()).description("disc|shape|centroid"))
      ->default_str("disc");
  command
      ->add_option(
          "--order", options->surface.order,
          "curved: by the outlines beyond each two as well, so that round structures keep their volume; linear: "
          "between the two alone. By default curved, but linear for centroid")
      ->transform(CLI::CheckedTransformer(orders()).description("linear|curved"));
  add_mesher_options(*command, options->surface.mesher);
  command
      ->add_option("--spacing-mm", options->surface.spacing_mm,
                   "Size of the lattice; an eightieth of the structure's extent by default")
      ->check(above(0.0));
  add_frame_names(*command, options->input.names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] {
    if (options->surface.order == GapOrder::kCurved && options->surface.guide == Guide::kCentroids) {
      throw CLI::ValidationError("--order", "curved needs --method disc or shape");
    }
    run(*options);
  });
}

}  // namespace fathom
