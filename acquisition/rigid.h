#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fathom {

/// Whether a 4x4 matrix turns and shifts but neither scales, shears nor mirrors: with R its upper left 3x3 part, no
/// element of R^T R - I is larger than 1e-3, as trackers' files state matrices with four to six digits, and det R > 0.
/// False where R has a number that is not finite.
bool is_rigid(const Eigen::Matrix4d& matrix);

/// The rigid motion whose rotation is nearest to the upper left part of a matrix that is_rigid.
Eigen::Isometry3d nearest_rigid(const Eigen::Matrix4d& matrix);

}  // namespace fathom
