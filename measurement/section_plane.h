#pragma once

#include <Eigen/Geometry>

namespace fathom {

/// Where a frame's plane lies and the coordinates (a, b) that surfaces use on it: millimetres along two perpendicular
/// unit axes. From frame to frame the coordinates are carried along the average normal of the two planes (Treece 2000,
/// figure 3.22), which keeps lengths, so that points of two neighbouring planes that lie over each other have (nearly)
/// the same (a, b).
struct SectionPlane {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d b_axis = Eigen::Vector3d::UnitY();

  Eigen::Vector3d normal() const { return a_axis.cross(b_axis); }
  Eigen::Vector3d at(const Eigen::Vector2d& ab_mm) const { return origin_mm + ab_mm.x() * a_axis + ab_mm.y() * b_axis; }
};

}  // namespace fathom
