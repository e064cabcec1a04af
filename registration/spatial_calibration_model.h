#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "registration/probe_poses.h"

namespace fathom {

/// The parameters of a spatial calibration, in the order of every vector and matrix about them.
enum SpatialParameter : int {
  kTx,
  kTy,
  kTz,
  kRx,
  kRy,
  kRz,
  kLogSx,
  kLogSy,
  kSkew,
  kLatency,
  kPhantomTx,
  kPhantomTy,
  kPhantomTz,
  kPhantomRx,
  kPhantomRy,
  kPhantomRz,
  kSpatialParameters
};

/// Their names in files: "tx_mm", ...
extern const std::array<const char*, kSpatialParameters> kSpatialParameterNames;

/// Which of them are fitted.
using SpatialMask = std::array<bool, kSpatialParameters>;

using SpatialVector = Eigen::Matrix<double, kSpatialParameters, 1>;

/// Values of the parameters. A small change turns `rotation` and the phantom on the right, in their own axes.
struct SpatialState {
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< probe from image axes
  double log_sx = 0.0;                                           ///< of millimetres per pixel
  double log_sy = 0.0;
  double skew = 0.0;  ///< the image's y axis leans by this much along x, as a tangent
  double latency_s = 0.0;
  Eigen::Isometry3d reference_from_phantom = Eigen::Isometry3d::Identity();

  Eigen::Affine3d probe_from_image() const;
  SpatialState moved(const SpatialVector& change) const;
};

/// The nearest state to a linear map from pixels to the probe: x and y axes as given, but turned apart evenly until
/// they stand as the skew says (upright where `keep_skew` is false).
SpatialState state_of(const Eigen::Matrix<double, 3, 2>& axes, const Eigen::Vector3d& origin, bool keep_skew);

/// One thing seen in one frame: the pixel at `position_px`, in phantom coordinates x, has rows * (x - origin) = 0.
/// For a wire the first two rows are across it, for a wall the first is its normal, for a point there are three.
struct SpatialObservation {
  int frame = 0;
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  int row_count = 0;  ///< rows that are not zero
};

/// Where a state puts an observation: its rows' errors in mm and, where asked for, how they change with the parameters.
Eigen::Vector3d spatial_error(const SpatialObservation& observation, const ProbePoses::At& pose,
                              const SpatialState& state, Eigen::Matrix<double, 3, kSpatialParameters>* jacobian);

}  // namespace fathom
