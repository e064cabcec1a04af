#include "acquisition/rigid.h"

#include <Eigen/LU>

namespace fathom {

namespace {
constexpr double kRigidTolerance = 1e-3;
}

bool is_rigid(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  if (!rotation.allFinite()) return false;
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  // An overflow to NaN compares false.
  return error <= kRigidTolerance && rotation.determinant() > 0.0;
}

}  // namespace fathom
