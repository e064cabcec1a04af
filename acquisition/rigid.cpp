#include "acquisition/rigid.h"

#include <Eigen/LU>
#include <Eigen/SVD>

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

Eigen::Isometry3d nearest_rigid(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

}  // namespace fathom
