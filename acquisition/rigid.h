#pragma once

#include <Eigen/Core>

namespace fathom {

/// Whether a 4x4 matrix turns and shifts but neither scales, shears nor mirrors: with R its upper left 3x3 part, no
/// element of R^T R - I is larger than 1e-3, as trackers' files state matrices with four to six digits, and det R > 0.
/// False where R has a number that is not finite.
bool is_rigid(const Eigen::Matrix4d& matrix);

}  // namespace fathom
