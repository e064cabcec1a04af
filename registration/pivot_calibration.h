#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "registration/probe_poses.h"

namespace fathom {

struct PivotOptions {
  int min_poses = 20;          ///< fewer valid ones are refused
  double min_share = 0.6;      ///< of the poses that must agree on one point
  double min_tilt_deg = 5.0;   ///< rms by which the direction that tilted least did so: less is no pivoting
  double max_tip_sd_mm = 1.0;  ///< worst standard deviation of the tip that is accepted
  double max_rms_mm = 5.0;     ///< a tip that moves by more is on no point
  std::uint64_t seed = 1;      ///< of the subsets of poses tried for the start

  void check() const;
};

/// Where the tip of a pointer is, from poses of the tool while its tip rests in one point.
struct PivotCalibration {
  Eigen::Vector3d tip_in_tool_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d pivot_in_reference_mm = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the tip, then the pivot, mm^2
  double rms_mm = 0.0;      ///< distance of the tip from the pivot, over the poses used
  double max_mm = 0.0;      ///< the largest of them
  double tilt_deg = 0.0;    ///< rms by which the direction of the tool that tilted least did so
  int poses_used = 0;       ///< not outliers
  int poses_valid = 0;      ///< outliers included
  double correlated = 1.0;  ///< so many poses count as one, as errors that follow each other are alike

  Eigen::Vector3d tip_sd_mm() const { return covariance.diagonal().head<3>().cwiseSqrt(); }
};

/// Least squares of R tip + p = pivot over the poses (R, p) of `tool`; up to two poses in five may be wrong, also all
/// on one side: poses are left out that stand out from the fit to the best half (least trimmed squares). The covariance
/// holds for errors that differ with direction and hang together in time. Throws Error where there are too few poses,
/// where they agree on no point, and where the tool did not turn enough, naming what is unknown.
PivotCalibration calibrate_pivot(const ProbePoses& tool, const PivotOptions& options = {});

}  // namespace fathom
