#include "registration/spatial_calibration_model.h"

#include <cmath>

namespace fathom {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  return Eigen::Matrix3d{{0, -v.z(), v.y()}, {v.z(), 0, -v.x()}, {-v.y(), v.x(), 0}};
}

Eigen::Quaterniond rotation_of(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

}  // namespace

const std::array<const char*, kSpatialParameters> kSpatialParameterNames = {
    "tx_mm",         "ty_mm",          "tz_mm",          "rx_rad",        "ry_rad",        "rz_rad",
    "log_sx",        "log_sy",         "skew",           "latency_s",     "phantom_tx_mm", "phantom_ty_mm",
    "phantom_tz_mm", "phantom_rx_rad", "phantom_ry_rad", "phantom_rz_rad"};

Eigen::Affine3d SpatialState::probe_from_image() const {
  const double sx = std::exp(log_sx);
  const double sy = std::exp(log_sy);
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  const Eigen::Matrix3d axes = rotation.toRotationMatrix();
  const Eigen::Vector3d x = axes.col(0) * sx;
  const Eigen::Vector3d y = sy * (axes.col(1) + skew * axes.col(0));
  map.linear() << x, y, axes.col(2) * 0.5 * (x.norm() + y.norm());
  map.translation() = translation_mm;
  return map;
}

SpatialState SpatialState::moved(const SpatialVector& change) const {
  SpatialState next = *this;
  next.translation_mm += change.segment<3>(kTx);
  next.rotation = (rotation * rotation_of(change.segment<3>(kRx))).normalized();
  next.log_sx += change[kLogSx];
  next.log_sy += change[kLogSy];
  next.skew += change[kSkew];
  next.latency_s += change[kLatency];
  Eigen::Isometry3d phantom = Eigen::Isometry3d::Identity();
  phantom.linear() = rotation_of(change.segment<3>(kPhantomRx)).toRotationMatrix();
  phantom.translation() = change.segment<3>(kPhantomTx);
  next.reference_from_phantom = reference_from_phantom * phantom;
  return next;
}

SpatialState state_of(const Eigen::Matrix<double, 3, 2>& axes, const Eigen::Vector3d& origin, bool keep_skew) {
  SpatialState state;
  state.translation_mm = origin;
  Eigen::Vector3d x = axes.col(0).normalized();
  Eigen::Vector3d y = axes.col(1).normalized();
  const Eigen::Vector3d normal = x.cross(y).normalized();
  if (!keep_skew) {
    const Eigen::Vector3d middle = (x + y).normalized();
    const Eigen::Vector3d aside = normal.cross(middle);
    x = (middle - aside).normalized();
    y = (middle + aside).normalized();
  }
  Eigen::Matrix3d rotation;
  rotation << x, normal.cross(x), normal;
  state.rotation = Eigen::Quaterniond(rotation).normalized();
  state.log_sx = std::log(axes.col(0).norm());
  const double upright = keep_skew ? axes.col(1).dot(rotation.col(1)) : axes.col(1).norm();
  state.log_sy = std::log(upright);
  state.skew = keep_skew ? axes.col(1).dot(x) / upright : 0.0;
  return state;
}

Eigen::Vector3d spatial_error(const SpatialObservation& observation, const ProbePoses::At& pose,
                              const SpatialState& state, Eigen::Matrix<double, 3, kSpatialParameters>* jacobian) {
  const double x = std::exp(state.log_sx) * observation.position_px.x();
  const double y = std::exp(state.log_sy) * observation.position_px.y();
  const Eigen::Vector3d in_image(x + state.skew * y, y, 0.0);
  const Eigen::Matrix3d turn = state.rotation.toRotationMatrix();
  const Eigen::Vector3d in_probe = state.translation_mm + turn * in_image;
  const Eigen::Isometry3d& phantom = state.reference_from_phantom;
  const Eigen::Vector3d in_phantom =
      phantom.linear().transpose() * (pose.reference_from_probe * in_probe - phantom.translation());
  if (jacobian != nullptr) {
    const Eigen::Matrix3d to_phantom = observation.rows * phantom.linear().transpose();
    const Eigen::Matrix3d from_probe = to_phantom * pose.reference_from_probe.linear();
    const Eigen::Matrix3d from_image = from_probe * turn;
    jacobian->middleCols<3>(kTx) = from_probe;
    jacobian->middleCols<3>(kRx) = -from_image * cross_matrix(in_image);
    jacobian->col(kLogSx) = from_image.col(0) * x;
    jacobian->col(kLogSy) = from_image * Eigen::Vector3d(state.skew * y, y, 0.0);
    jacobian->col(kSkew) = from_image.col(0) * y;
    jacobian->col(kLatency) = to_phantom * pose.velocity_mm_s + from_probe * pose.turning_rad_s.cross(in_probe);
    jacobian->middleCols<3>(kPhantomTx) = -observation.rows;
    jacobian->middleCols<3>(kPhantomRx) = observation.rows * cross_matrix(in_phantom);
  }
  return observation.rows * (in_phantom - observation.origin_mm);
}

}  // namespace fathom
