#include "acquisition/volume_file.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "acquisition/file_recording.h"
#include "acquisition/header_text.h"
#include "acquisition/pixel_source.h"
#include "acquisition/sequence_file.h"
#include "acquisition/sequence_writer.h"
#include "acquisition/volume_geometry.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::uint64_t kMostVoxels = 1ull << 30;  // 1024 a side: 8 GB of doubles
constexpr std::uint64_t kMostSlices = 65535;       // as pixels on a side of a slice

bool has_fields_of_frames(const RecordingHeader& header) {
  return !header.transforms.empty() ||
         std::any_of(header.frames.begin(), header.frames.end(), [](const FrameHeader& frame) {
           return frame.time_s || !frame.image_status.empty() || !frame.fields.empty();
         });
}

/// Why a file is no volume, for a message; empty where it is one.
std::optional<std::string> fault_as_volume(const SequenceFile& sequence) {
  const StatedSizes& sizes = sequence.sizes;
  if (has_fields_of_frames(sequence.header)) return "is a recording, with fields of its frames";
  const bool has_axis_without_space =
      sequence.nrrd_space && sequence.nrrd_space->directions.find("none") != std::string::npos;
  if (sizes.is_list || has_axis_without_space) return "is a recording, as its last axis is a list of frames";
  if (sequence.orientation_is_stated) return "is a recording, as it says how its ultrasound images lie";
  if (sizes.channels != 1) return "has " + std::to_string(sizes.channels) + " channels";
  if (sizes.axes != 3) return "has " + std::to_string(sizes.axes) + " axes, not three of space";
  if (!sequence.header.has_images() || sizes.frames == 0) return "has no voxels";
  return std::nullopt;
}

std::optional<std::string> fault_of_size(const StatedSizes& sizes, int depth) {
  if (const auto fault = fault_of_image_format(sizes, depth)) return fault;
  if (sizes.frames <= kMostSlices && sizes.width * sizes.height * sizes.frames <= kMostVoxels) return std::nullopt;
  return "has " + std::to_string(sizes.width) + " x " + std::to_string(sizes.height) + " x " +
         std::to_string(sizes.frames) + " voxels; a volume may have 2^30, and " + std::to_string(kMostSlices) +
         " slices";
}

/// The slice of a volume, as a view.
cv::Mat slice_view(const cv::Mat& voxels, int slice) {
  return cv::Mat(voxels.size[1], voxels.size[2], voxels.type(), const_cast<uchar*>(voxels.ptr(slice)), voxels.step[1]);
}

/// A volume's slices as frames.
class Slices : public Recording {
 public:
  Slices(const Volume& volume, std::string name) : Recording(std::move(name), header_of(volume)), volume_(volume) {}
  cv::Mat image(int frame) const override { return slice_view(volume_.voxels, frame); }

 private:
  static RecordingHeader header_of(const Volume& volume) {
    RecordingHeader header;
    header.width = volume.voxels.size[2];
    header.height = volume.voxels.size[1];
    header.pixel_type = volume.voxels.type();
    header.frames.resize(static_cast<std::size_t>(volume.voxels.size[0]));
    return header;
  }

  const Volume& volume_;
};

/// What keeps a volume from being written, for a message; empty where nothing does.
std::optional<std::string> fault_of_volume(const Volume& volume) {
  const cv::Mat& voxels = volume.voxels;
  if (voxels.empty() || voxels.dims != 3) return "the volume has no voxels; there is nothing to write";
  constexpr std::array<int, 6> kDepths = {CV_8U, CV_8S, CV_16U, CV_16S, CV_32F, CV_64F};
  if (voxels.channels() != 1 || std::find(kDepths.begin(), kDepths.end(), voxels.depth()) == kDepths.end()) {
    return "the volume's voxels are neither integers of 8 or 16 bits nor float nor double; convert them first";
  }
  StatedSizes sizes;
  sizes.width = static_cast<std::uint64_t>(voxels.size[2]);
  sizes.height = static_cast<std::uint64_t>(voxels.size[1]);
  sizes.frames = static_cast<std::uint64_t>(voxels.size[0]);
  if (auto fault = fault_of_size(sizes, voxels.depth())) return "the volume " + *fault;
  if (auto fault = fault_of_volume_geometry(volume.reference_from_voxel)) return "of the volume, " + *fault;
  return std::nullopt;
}

}  // namespace

bool is_volume_file(const std::filesystem::path& path) {
  return !fault_as_volume(read_sequence(std::make_shared<InputFile>(path)));
}

Volume read_volume(const std::filesystem::path& path, const Progress& progress) {
  const auto file = std::make_shared<InputFile>(path);
  const SequenceFile sequence = read_sequence(file);
  if (const auto fault = fault_as_volume(sequence)) file->fail(*fault + "; give a volume of one channel");
  const RecordingHeader& header = sequence.header;
  if (const auto fault = fault_of_size(sequence.sizes, CV_MAT_DEPTH(header.pixel_type))) file->fail(*fault);
  Volume volume;
  volume.reference_from_voxel = volume_geometry(sequence, *file);
  const std::array<int, 3> sizes = {header.frame_count(), header.height, header.width};
  try {
    volume.voxels.create(3, sizes.data(), header.pixel_type);
  } catch (const cv::Exception&) {
    file->fail("has more voxels than memory can hold; close other programs or use a smaller volume");
  }
  const auto pixels = open_pixels(sequence);
  for (int slice = 0; slice < header.frame_count(); ++slice) {
    report(progress, static_cast<double>(slice) / header.frame_count());
    cv::Mat view = slice_view(volume.voxels, slice);
    pixels->frame(slice).copyTo(view);
  }
  report(progress, 1.0);
  return volume;
}

void write_volume(const Volume& volume, const std::filesystem::path& path, const VolumeWriteOptions& options,
                  const Progress& progress) {
  if (const auto fault = fault_of_volume(volume)) throw Error(printable(path.string()) + ": " + *fault);
  write_sequence(Slices(volume, path.string()), path,
                 {.compressed = options.compress, .reference_from_voxel = volume.reference_from_voxel}, progress);
}

}  // namespace fathom
