#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Geometry>

#include "acquisition/recording.h"

namespace fathom {

/// How a sequence metafile is to be written.
struct SequenceLayout {
  bool compressed = false;
  /// Of a volume, whose slices are the frames; empty: a recording.
  std::optional<Eigen::Affine3d> reference_from_voxel;
};

/// Writes .mha, .mhd or .nrrd, as the extension says: see write_recording.
void write_sequence(const Recording& recording, const std::filesystem::path& path, const SequenceLayout& layout,
                    const Progress& progress);

}  // namespace fathom
