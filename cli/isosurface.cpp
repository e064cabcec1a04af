#include "surface/isosurface.h"

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "acquisition/volume_file.h"
#include "cli/command.h"
#include "cli/mesh_output.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "core/progress.h"
#include "segmentation/morphology.h"

namespace fathom {

namespace {

struct IsosurfaceCommand {
  std::string volume;
  IsosurfaceOptions surface;
  double open_mm = 0.0;  // 0: not
  double close_mm = 0.0;
  MeshOutput output;
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
  make_mesh(command.output, "--cap closes it along the border of the volume", [&command] {
    const Volume volume = read_volume(command.volume, progress_bar("reading"));
    return [&command, volume] { return mesh_of(volume, command); };
  });
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
  add_mesh_output_options(*command, options->output);
  command->callback([options] { run(*options); });
}

}  // namespace fathom
