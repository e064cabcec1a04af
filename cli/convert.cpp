#include <iostream>
#include <memory>

#include "acquisition/live/recording_folder.h"
#include "acquisition/recording.h"
#include "acquisition/volume_file.h"
#include "cli/command.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/error.h"
#include "core/printable.h"
#include "surface/mesh_file.h"

namespace fathom {

namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  bool compress = false;
  bool json = false;
};

void convert_mesh(const ConvertOptions& options) {
  const Mesh mesh = read_mesh(options.in);
  if (!is_mesh_file(options.out)) {
    throw Error(printable(options.out) +
                ": a mesh cannot be written as that; name a file ending in .ply, .stl, .obj, " + ".off or .wrl");
  }
  if (options.compress) {
    throw Error(printable(options.out) + ": meshes are not compressed; leave out --compress");
  }
  write_mesh(mesh, options.out, {}, progress_bar("converting"));
  const bool loses_signs = !mesh.sweep_signs.empty() && !keeps_sweep_signs(options.out);
  nlohmann::ordered_json warnings = nlohmann::ordered_json::array();
  if (loses_signs) {
    warnings.push_back("the format does not keep which triangles count negative in the volume; .ply does");
  }
  if (options.json) {
    print_json({{"vertices", mesh.vertices.size()},
                {"triangles", mesh.triangles.size()},
                {"warnings", warnings},
                {"out", options.out}});
    return;
  }
  std::cout << "wrote " << mesh.vertices.size() << " vertices and " << mesh.triangles.size() << " triangles to "
            << options.out << "\n";
  for (const auto& warning : warnings) std::cout << "warning: " << warning.get<std::string>() << "\n";
}

void convert_volume(const ConvertOptions& options) {
  const Volume volume = read_volume(options.in, progress_bar("reading"));
  write_volume(volume, options.out, {.compress = options.compress}, progress_bar("writing"));
  const cv::MatSize& size = volume.voxels.size;
  if (options.json) {
    print_json({{"dimensions", {size[2], size[1], size[0]}}, {"out", options.out}});
  } else {
    std::cout << "wrote " << size[2] << " x " << size[1] << " x " << size[0] << " voxels to " << options.out << "\n";
  }
}

void convert_recording(const ConvertOptions& options) {
  const auto recording = open_only_recording(options.in, "convert");
  if (is_mesh_file(options.out)) {
    throw Error(printable(options.out) + ": a recording cannot be written as a mesh; name a file ending in .mha, " +
                ".mhd or .nrrd");
  }
  write_recording(*recording, options.out, {.compress = options.compress}, progress_bar("converting"));
  if (options.json) {
    print_json({{"frames", recording->header().frame_count()}, {"out", options.out}});
  } else {
    std::cout << "wrote " << recording->header().frame_count() << " frames to " << options.out << "\n";
  }
}

void run(const ConvertOptions& options) {
  if (is_exam(options.in) || is_recording_folder(options.in)) return convert_recording(options);
  if (is_mesh_file(options.in)) return convert_mesh(options);
  if (is_volume_file(options.in)) return convert_volume(options);
  convert_recording(options);
}

}  // namespace

void add_convert(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand("convert", "Write a recording, a volume or a mesh in another format");
  command
      ->add_option("IN", options->in,
                   "A .mha, .mhd or .nrrd sequence or volume; an exam of one recording; or a .ply, .stl, .obj, .off or "
                   ".wrl mesh")
      ->required();
  command->add_option("OUT", options->out, "The file to write; its extension names the format")->required();
  command->add_flag("--compress", options->compress, "Compress the pixels (smaller, but slower to open)");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
