#pragma once

#include <filesystem>

#include "core/progress.h"
#include "core/volume.h"

namespace fathom {

/// Whether a file (.mha, .mhd, .nrrd; its first bytes decide, not its name) is a voxel array: three axes of space and
/// one channel, without fields of frames, an axis of kind list or time, or an orientation of ultrasound images.
/// Everything else that can be read is a recording. Throws Error when the header is damaged.
bool is_volume_file(const std::filesystem::path& path);

/// Reads a voxel array of 8-bit or 16-bit integers, float or double.
///
/// `reference_from_voxel` is in millimetres and in the coordinates that MetaImage has, x to the Left, y to Posterior, z
/// to Superior (LPS): from ElementSpacing, Offset (or Position, Origin) and TransformMatrix, in which every three
/// numbers are the direction of one axis; in NRRD from `space directions` and `space origin`, or `spacings`, brought to
/// LPS where `space` is RAS or LAS. A determinant below 0 is kept as read: such a volume is mirrored.
///
/// Throws Error when is_volume_file does not hold, the geometry is not finite or not invertible or in another unit,
/// there are more than 2^30 voxels, or the file is damaged; sizes are compared with the file's length before memory is
/// taken. Throws Cancelled.
Volume read_volume(const std::filesystem::path& path, const Progress& progress = {});

struct VolumeWriteOptions {
  bool compress = false;  ///< zlib in MetaImage, gzip in NRRD
};

/// Writes the format named by the extension: .mha, .mhd (with a .raw beside it, or .zraw where compressed) or .nrrd.
/// Voxels read back as they are. So does the geometry in NRRD; MetaImage holds directions and spacing apart, whose
/// products are the same to a rounding error. The file appears whole or not at all.
/// Throws Error for another extension, when read_volume would refuse the volume, and when the disk fails; Cancelled.
void write_volume(const Volume& volume, const std::filesystem::path& path, const VolumeWriteOptions& options = {},
                  const Progress& progress = {});

}  // namespace fathom
