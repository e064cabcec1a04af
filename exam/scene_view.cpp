#include "exam/scene_view.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace fathom {

Eigen::Matrix3d scene_view(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& depth) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) spread += (point - mean) * (point - mean).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  constexpr double kTooOblique = 0.3;  // a depth this nearly along the long axis says little about what is down
  const Eigen::Vector3d right = axes.col(2);
  const Eigen::Vector3d across = depth - right * right.dot(depth);
  const Eigen::Vector3d down = across.norm() > kTooOblique ? across.normalized() : Eigen::Vector3d(axes.col(1));
  Eigen::Matrix3d view;
  view << right.transpose(), down.transpose(), right.cross(down).transpose();
  return Eigen::AngleAxisd(-0.45, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.65, Eigen::Vector3d::UnitY()) * view;
}

Eigen::Vector3d mean_depth(const FrameLocator& locator, const std::vector<Structure>& structures) {
  Eigen::Vector3d depth = Eigen::Vector3d::Zero();
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      const auto reference_from_image = locator.reference_from_image(contour.frame);
      if (reference_from_image) depth += reference_from_image->linear().col(1).normalized();
    }
  }
  return depth.isZero(1e-9) ? depth : Eigen::Vector3d(depth.normalized());
}

cv::Scalar color_of(const Structure& structure) {
  const unsigned long rgb = std::stoul(structure.color.substr(1), nullptr, 16);
  return {static_cast<double>(rgb & 0xff), static_cast<double>(rgb >> 8 & 0xff), static_cast<double>(rgb >> 16)};
}

}  // namespace fathom
