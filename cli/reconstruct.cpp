#include "registration/reconstruct.h"

#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "acquisition/recording.h"
#include "acquisition/volume_file.h"
#include "cli/command.h"
#include "cli/image_area.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "registration/fill_holes.h"

namespace fathom {

namespace {

struct ReconstructCommand {
  ScanInput input;
  std::string out;
  ImageArea area;
  double max_memory_mb = 4096.0;
  bool fill_holes = false;
  ReconstructOptions reconstruct;
  FillHolesOptions holes;
  VolumeWriteOptions write;
  bool json = false;
};

void run(const ReconstructCommand& command) {
  const std::string extension = std::filesystem::path(command.out).extension().string();
  if (extension != ".mha" && extension != ".mhd" && extension != ".nrrd") {
    throw Error(command.out + ": voxel arrays are written to .mha, .mhd or .nrrd; name the file so");
  }
  ReconstructOptions options = command.reconstruct;
  options.max_bytes = command.max_memory_mb * 1e6;
  options.clip = command.area.rectangle();
  const ScanInput& input = command.input;
  const std::string calibration_name = calibration_file(input, read_if_exam(input.recording));
  const auto recording = open_only_recording(input.recording, "reconstruct");
  const Calibration calibration = read_calibration(calibration_name, input.names.probe);
  const FrameLocator locator(*recording, calibration, input.names);
  options.fan = command.area.fan(calibration);

  const auto start = std::chrono::steady_clock::now();
  const Progress progress = progress_bar("reconstructing");
  Reconstructed made = reconstruct(*recording, locator, options, part_of(progress, 0.0, 0.7));
  const std::int64_t in_holes = command.fill_holes ? fill_holes(made.volume.voxels, made.filled, command.holes) : 0;
  const cv::Mat marks(1, static_cast<int>(made.filled.total()), CV_8U, made.filled.data);
  const double filled = static_cast<double>(cv::countNonZero(marks)) / static_cast<double>(made.filled.total());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_volume(made.volume, command.out, command.write, part_of(progress, 0.8, 1.0));

  const cv::Mat& voxels = made.volume.voxels;
  const Eigen::Vector3d origin = made.volume.reference_from_voxel.translation();
  const double spacing = options.spacing_mm;
  if (command.json) {
    print_json({{"dimensions", {voxels.size[2], voxels.size[1], voxels.size[0]}},
                {"spacing_mm", {spacing, spacing, spacing}},
                {"origin_mm", {origin.x(), origin.y(), origin.z()}},
                {"filled", filled},
                {"holes_filled", in_holes},
                {"seconds", seconds}});
    return;
  }
  std::cout << command.out << ": " << voxels.size[2] << " x " << voxels.size[1] << " x " << voxels.size[0]
            << " voxels of " << number_text(spacing, 3) << " mm from (" << number_text(origin.x(), 1) << ", "
            << number_text(origin.y(), 1) << ", " << number_text(origin.z(), 1) << ") mm, "
            << number_text(100.0 * filled, 1) << " % with a value, in " << number_text(seconds, 2) << " s\n";
}

}  // namespace

void add_reconstruct(CLI::App& app) {
  static const std::map<std::string, Insertion> insertions = {{"nearest", Insertion::kNearest},
                                                              {"linear", Insertion::kLinear}};
  static const std::map<std::string, Compounding> compoundings = {
      {"mean", Compounding::kMean}, {"latest", Compounding::kLatest}, {"max", Compounding::kMax}};
  auto options = std::make_shared<ReconstructCommand>();
  CLI::App* command = app.add_subcommand("reconstruct", "Make a voxel array of a sweep, for programs that need one");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  command->add_option("--spacing-mm", options->reconstruct.spacing_mm, "Side of a voxel")
      ->required()
      ->check(above(0.0));
  command->add_option("--out", options->out, "The volume to write: .mha, .mhd or .nrrd")->required();
  command->add_option("--mode", options->reconstruct.insertion, "How pixels go into voxels: nearest or linear")
      ->transform(CLI::CheckedTransformer(insertions).description("nearest|linear"))
      ->default_str("nearest");
  command
      ->add_option("--compound", options->reconstruct.compounding,
                   "What becomes of several pixels of a voxel: mean, latest or max")
      ->transform(CLI::CheckedTransformer(compoundings).description("mean|latest|max"))
      ->default_str("mean");
  command->add_flag("--fill-holes", options->fill_holes, "Give values to empty voxels between filled ones");
  command->add_option("--max-gap", options->holes.max_gap_voxels, "Longest gap that is filled, in voxels")
      ->check(CLI::Range(1, 15))
      ->capture_default_str();
  add_image_area(*command, options->area);
  command->add_option("--max-memory-mb", options->max_memory_mb, "Memory allowed")
      ->check(above(0.0))
      ->capture_default_str();
  command->add_flag("--compress", options->write.compress, "Compress the file");
  add_frame_names(*command, options->input.names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
