#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "acquisition/volume_file.h"
#include "cli/command.h"
#include "cli/output.h"

namespace fathom {

namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  bool compress = false;
  bool json = false;
};

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
  const auto recording = open_recording(options.in);
  write_recording(*recording, options.out, {.compress = options.compress}, progress_bar("converting"));
  if (options.json) {
    print_json({{"frames", recording->header().frame_count()}, {"out", options.out}});
  } else {
    std::cout << "wrote " << recording->header().frame_count() << " frames to " << options.out << "\n";
  }
}

void run(const ConvertOptions& options) {
  if (is_volume_file(options.in)) return convert_volume(options);
  convert_recording(options);
}

}  // namespace

void add_convert(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand("convert", "Write a recording or a volume in another format");
  command->add_option("IN", options->in, "A .mha, .mhd or .nrrd sequence or volume")->required();
  command->add_option("OUT", options->out, "The file to write; its extension names the format")->required();
  command->add_flag("--compress", options->compress, "Compress the pixels (smaller, but slower to open)");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
