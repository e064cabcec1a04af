#include "surface/isosurface.h"

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "acquisition/volume_file.h"
#include "cli/command.h"
#include "cli/mesh_output.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "segmentation/morphology.h"
#include "surface/mesh_file.h"

namespace fathom {

namespace {

struct IsosurfaceCommand {
  std::string volume;
  std::string out;
  IsosurfaceOptions surface;
  double open_mm = 0.0;  // 0: not
  double close_mm = 0.0;
  bool json = false;
};

// To open what is inside is to close what is outside, where inside means dark.
Volume cleaned(Volume volume, const IsosurfaceCommand& command) {
  const bool dark = command.surface.inside_below;
  if (command.open_mm > 0.0) {
    volume = dark ? close_slices(volume, command.open_mm) : open_slices(volume, command.open_mm);
  }
  if (command.close_mm > 0.0) {
    volume = dark ? open_slices(volume, command.close_mm) : close_slices(volume, command.close_mm);
  }
  return volume;
}

// The library knows no file; its complaints are about this one.
Mesh mesh_of(Volume volume, const IsosurfaceCommand& command) {
  try {
    volume = cleaned(std::move(volume), command);
    return isosurface(volume, command.surface, progress_bar("meshing"));
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error(command.volume + ": " + error.what());
  }
}

void run(const IsosurfaceCommand& command) {
  require_mesh_name(command.out);
  AtomicFile file(command.out);
  Volume volume = read_volume(command.volume, progress_bar("reading"));
  const auto began = std::chrono::steady_clock::now();
  const Mesh mesh = mesh_of(std::move(volume), command);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  MeshReport report = report_of(mesh, "--cap closes it along the border of the volume");
  report.seconds = took.count();
  write_mesh(mesh, file);
  file.commit();
  print_mesh_report(report, command.out, command.json);
}

}  // namespace

void add_isosurface(CLI::App& app) {
  auto options = std::make_shared<IsosurfaceCommand>();
  IsosurfaceOptions& surface = options->surface;
  static const std::map<std::string, bool> kSides = {{"above", false}, {"below", true}};
  CLI::App* command = app.add_subcommand("isosurface", "Make a surface mesh of a volume, where it has one value");
  command->add_option("VOLUME", options->volume, "A .mha, .mhd or .nrrd volume")->required();
  command->add_option("--value", surface.value, "The value on the surface")->required()->check(finite());
  command
      ->add_option("--inside", surface.inside_below,
                   "above: inside is this value and more (default); below: inside is less")
      ->transform(CLI::CheckedTransformer(kSides).description(""))
      ->type_name("above|below");
  command->add_flag("--cap", surface.cap, "Close the surface along the border of the volume");
  command
      ->add_option("--open-mm", options->open_mm,
                   "First remove, slice by slice, what a disc of this radius does not fit into")
      ->check(at_least(0));
  command
      ->add_option("--close-mm", options->close_mm,
                   "Then fill, slice by slice, what a disc of this radius does not fit into outside")
      ->check(at_least(0));
  command
      ->add_option("--spacing-mm", surface.spacing_mm,
                   "Distance of the lattice's layers (default: the smallest distance of voxels)")
      ->check(above(0));
  add_mesher_options(*command, surface.mesher);
  command->add_option("--out", options->out, "The mesh to write: .ply, .stl, .obj, .off or .wrl")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
