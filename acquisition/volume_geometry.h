#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "acquisition/sequence_file.h"

namespace fathom {

// Where the voxels of a volume lie: the fields of a header and the transform from indices to millimetres.

/// What keeps a transform from being that of a volume, for a message; empty where nothing does. Voxels have sides of
/// 1e-6 to 1e6 mm, lie within 1e9 mm, and their axes span space.
std::optional<std::string> fault_of_volume_geometry(const Eigen::Affine3d& reference_from_voxel);

/// The transform that a volume's header states, as read_volume says. Throws Error with the name of `file`.
Eigen::Affine3d volume_geometry(const SequenceFile& sequence, const InputFile& file);

/// The lines TransformMatrix, Offset, CenterOfRotation and ElementSpacing.
std::string metaimage_volume_lines(const Eigen::Affine3d& reference_from_voxel);

/// The lines "space", "space directions" and "space origin".
std::string nrrd_volume_lines(const Eigen::Affine3d& reference_from_voxel);

}  // namespace fathom
