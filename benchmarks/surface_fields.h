#pragma once

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/volume.h"

namespace fathom::benchmarks {

/// A ball, or one with bumps, that fills four fifths of a box of `size` voxels; positive inside, about as distance.
inline double ball_field(int size, bool bumpy, const Eigen::Vector3d& voxel) {
  const Eigen::Vector3d p = voxel - Eigen::Vector3d::Constant(0.5 * (size - 1)) - Eigen::Vector3d(0.13, -0.21, 0.07);
  const double r = p.norm() + 1e-9;
  const double bumps =
      bumpy ? 0.35 * std::sin(6.0 * p.x() / r) * std::sin(7.0 * p.y() / r) * std::sin(5.0 * p.z() / r) : 0.0;
  return 0.4 * size * (1.0 - (bumpy ? 0.15 : 0.0) + bumps) - r;
}

inline Volume ball_volume(int size, bool bumpy) {
  Volume volume;
  const std::array<int, 3> sizes = {size, size, size};
  volume.voxels.create(3, sizes.data(), CV_32F);
  for (int k = 0; k < size; ++k) {
    for (int j = 0; j < size; ++j) {
      float* row = volume.voxels.ptr<float>(k, j);
      for (int i = 0; i < size; ++i) row[i] = static_cast<float>(ball_field(size, bumpy, Eigen::Vector3d(i, j, k)));
    }
  }
  return volume;
}

}  // namespace fathom::benchmarks
