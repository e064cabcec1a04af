#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace fathom {

/// A voxel array and where it lies.
struct Volume {
  /// Three dimensions, `voxels.size` = {slices, rows, columns}; one channel.
  cv::Mat voxels;
  /// From indices (column, row, slice), at the voxels' centres, to millimetres; spacing, rotation and origin.
  Eigen::Affine3d reference_from_voxel = Eigen::Affine3d::Identity();
};

}  // namespace fathom
