#include <cassert>
#include <cmath>

#include "registration/wire_identification.h"

namespace fathom {

namespace {

constexpr int kMaxSteps = 30;
constexpr double kSettled = 1e-8;     // mm, radians and logarithms of scales alike: far below any echo's precision
constexpr double kLargestStep = 0.5;  // radians and logarithms of scales: beyond it the linearisation says nothing
constexpr double kDamping = 1e-9;     // of the largest diagonal term: motions that the points cannot see stay put

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

}  // namespace

double distance_to_wire_mm(const Wire& wire, const Eigen::Vector3d& x_in_phantom_mm) {
  const Eigen::Vector3d along = (wire.back - wire.front).normalized();
  const Eigen::Vector3d from_front = x_in_phantom_mm - wire.front;
  return (from_front - along * along.dot(from_front)).norm();
}

std::optional<Eigen::Affine3d> fit_image_plane(std::span<const Eigen::Vector2d> at_px, std::span<const Wire> wires,
                                               const Eigen::Affine3d& start,
                                               const std::optional<Eigen::Vector2d>& pixel_mm) {
  assert(at_px.size() == wires.size());
  if (at_px.empty()) return std::nullopt;
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& at : at_px) middle_px += at / static_cast<double>(at_px.size());

  // The plane turns about the points' middle, which keeps turn and shift apart.
  Eigen::Vector3d origin = start * Eigen::Vector3d(middle_px.x(), middle_px.y(), 0.0);
  const Eigen::Vector3d right = start.linear().col(0);
  const Eigen::Vector3d down = start.linear().col(1);
  Eigen::Vector2d pixel = pixel_mm.value_or(Eigen::Vector2d(right.norm(), down.norm()));
  Eigen::Matrix3d turn;
  turn.col(0) = right.normalized();
  turn.col(1) = (down - turn.col(0) * turn.col(0).dot(down)).normalized();
  turn.col(2) = turn.col(0).cross(turn.col(1));
  if (!turn.allFinite()) return std::nullopt;

  const int unknowns = pixel_mm ? 6 : 8;
  bool settled = false;
  for (int step = 0; step < kMaxSteps && !settled; ++step) {
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
    Eigen::Matrix<double, 8, 1> gradient = Eigen::Matrix<double, 8, 1>::Zero();
    for (std::size_t i = 0; i < at_px.size(); ++i) {
      const Eigen::Vector2d from_middle = (at_px[i] - middle_px).cwiseProduct(pixel);
      const Eigen::Vector3d in_plane = turn.leftCols<2>() * from_middle;
      const Eigen::Vector3d along = (wires[i].back - wires[i].front).normalized();
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along * along.transpose();
      const Eigen::Vector3d residual = across * (origin + in_plane - wires[i].front);
      Eigen::Matrix<double, 3, 8> jacobian = Eigen::Matrix<double, 3, 8>::Zero();
      jacobian.leftCols<3>() = across;
      jacobian.middleCols<3>(3) = -across * cross_matrix(in_plane);
      jacobian.col(6) = across * turn.col(0) * from_middle.x();
      jacobian.col(7) = across * turn.col(1) * from_middle.y();
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * residual;
    }
    Eigen::MatrixXd damped = normal.topLeftCorner(unknowns, unknowns);
    damped.diagonal().array() += kDamping * damped.diagonal().maxCoeff();
    Eigen::VectorXd change = -damped.ldlt().solve(gradient.head(unknowns));
    if (!change.allFinite()) return std::nullopt;
    const double largest = change.tail(unknowns - 3).cwiseAbs().maxCoeff();
    if (largest > kLargestStep) change *= kLargestStep / largest;
    origin += change.head<3>();
    const Eigen::Vector3d turned = change.segment<3>(3);
    if (turned.norm() > 0.0) {
      turn = (Eigen::AngleAxisd(turned.norm(), turned.normalized()).toRotationMatrix() * turn).eval();
    }
    if (!pixel_mm) pixel = pixel.cwiseProduct(change.tail<2>().array().exp().matrix());
    settled = change.cwiseAbs().maxCoeff() < kSettled;
  }
  Eigen::Affine3d fitted = Eigen::Affine3d::Identity();
  fitted.linear() = turn * Eigen::Vector3d(pixel.x(), pixel.y(), pixel.mean()).asDiagonal();
  fitted.translation() = origin - fitted.linear() * Eigen::Vector3d(middle_px.x(), middle_px.y(), 0.0);
  if (!fitted.matrix().allFinite()) return std::nullopt;
  return fitted;
}

}  // namespace fathom
