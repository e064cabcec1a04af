#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/random.h"

namespace fathom {

inline const Eigen::Vector3d kTip(12.0, -8.0, 165.0);
inline const Eigen::Vector3d kPivot(310.0, -120.0, 840.0);

inline Eigen::Matrix3d turn(const Eigen::Vector3d& rotation) {
  if (rotation.norm() == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
}

inline Eigen::Vector3d normal3(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

/// A tool whose tip rests in kPivot while its shaft circles in a cone, by tilts (rad) about x and y.
inline std::vector<std::optional<Eigen::Isometry3d>> pivoting(int count, double tilt_x, double tilt_y, double twist,
                                                              double noise_mm, double noise_rad, Random& random) {
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  const Eigen::Matrix3d base = turn({0.4, -2.1, 0.7});
  for (int i = 0; i < count; ++i) {
    const double angle = 0.05 * i;
    const Eigen::Matrix3d true_turn = base * turn({0.0, 0.0, twist * std::sin(0.31 * angle)}) *
                                      turn({tilt_x * std::sin(angle), tilt_y * std::cos(1.3 * angle), 0.0});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = true_turn * turn(noise_rad * normal3(random));
    pose.translation() = kPivot - true_turn * kTip + noise_mm * normal3(random);
    poses.emplace_back(pose);
  }
  return poses;
}

}  // namespace fathom
