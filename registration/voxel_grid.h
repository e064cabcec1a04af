#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include "registration/frame_geometry.h"

namespace fathom {

/// Where the voxels of a reconstruction lie: along the axes of the reference, cubes.
struct VoxelGrid {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  ///< centre of voxel (0, 0, 0)
  double spacing_mm = 1.0;
  std::array<std::int64_t, 3> size = {1, 1, 1};  ///< columns, rows, slices

  std::int64_t voxels() const { return size[0] * size[1] * size[2]; }
  Eigen::Affine3d reference_from_voxel() const;
};

/// The part of images that is used: all of it, or a rectangle, cut to the image. Throws Error where nothing is left.
cv::Rect clipped(cv::Size image_size, const std::optional<cv::Rect>& clip);

/// The grid around frames, as PLUS lays it: the clip rectangle's corners at its origin and at min(origin + size, last
/// pixel), mapped by every frame; the smallest coordinates are the origin, and round(extent / spacing) + 1 the size.
/// `frames` is not empty; `spacing_mm` > 0. Throws Error when an axis would get more than 2^30 voxels.
VoxelGrid grid_around(const std::vector<PlacedFrame>& frames, cv::Size image_size, const std::optional<cv::Rect>& clip,
                      double spacing_mm);

/// Throws Error, with the finest spacing that fits, when the grid has more than 2^30 voxels or takes more than
/// `max_bytes` at `bytes_per_voxel`. To be asked before memory is taken. `name` is the recording's.
void require_fits(const VoxelGrid& grid, double bytes_per_voxel, double max_bytes, const std::string& name);

}  // namespace fathom
