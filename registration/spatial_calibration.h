#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "registration/calibration.h"
#include "registration/spatial_calibration_model.h"

namespace fathom {

/// What the probe looks at.
enum class CalibrationTarget { kWires, kWall, kPoint };

/// For messages: "the wires", "the floor", "the point".
std::string name_of(CalibrationTarget target);

/// What may be fitted beside the six pose parameters and the two pixel scales.
struct SpatialOptions {
  CalibrationTarget target = CalibrationTarget::kWires;  ///< decides on the advice in messages
  SpatialMask phantom{};         ///< parameters of the phantom's pose that are fitted in any case
  bool try_latency = true;       ///< fit the latency if cross-validation says that the sweep supports it
  bool try_skew = true;          ///< the same for the skew
  double max_latency_s = 0.7;    ///< latencies beyond this are not looked for
  int min_frames = 12;           ///< with observations and a pose: fewer are refused
  double max_point_sd_mm = 2.0;  ///< worst standard deviation of a pixel's place seen; beyond, the motion was too poor
  std::uint64_t seed = 1;        ///< of the subsets of frames tried for the start

  void check() const;
};

/// A fit of the model to observations.
struct SpatialFit {
  SpatialState state;
  SpatialMask fitted{};
  std::vector<int> parameters;  ///< those fitted, in order: the rows of `covariance`
  Eigen::MatrixXd covariance;
  double rms_mm = 0.0;     ///< of the distances of the observations used
  std::vector<bool> used;  ///< one an observation: neither outlier nor without a pose
  int frames_used = 0;
  int frames_seen = 0;             ///< that have observations
  double worst_point_sd_mm = 0.0;  ///< of the pixels observed, from `covariance`
};

/// Robust least squares: Cauchy's loss first, then frames and points that stand out are left out and the rest is
/// fitted plainly. The covariance is of errors that are alike within a frame, whatever their sizes (sums of products of
/// the frames' gradients, corrected for the fitted parameters' own pull), times the number of neighbouring frames whose
/// errors hang together.
/// Throws Error, naming the movement to add, where the motion does not determine the parameters.
SpatialFit fit_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                       const SpatialState& start, const SpatialMask& fitted, const SpatialOptions& options);

/// Fits from several starts, keeps the best, and adds latency and skew where leaving out blocks of frames shows that
/// they predict the frames left out better, beyond chance. A latency is found on poses of even noise and then held.
/// `name` is of the recording, for messages. Throws Error when too few frames have observations and poses, or none of
/// the starts leads to a plausible result.
SpatialFit calibrate_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const std::vector<SpatialState>& starts, const SpatialOptions& options);

/// Mean squared distance of each frame's observations (mm^2) when `fitted` is fitted to the other blocks of frames;
/// only those of `fit.used` take part. In order of the frames; pairs of frame and value.
std::vector<std::pair<int, double>> cross_validated(const ProbePoses& poses,
                                                    const std::vector<SpatialObservation>& observations,
                                                    const SpatialFit& fit);

/// The fit as a calibration file has it. Parameters of the phantom are left out of the covariance.
Calibration calibration_of(const SpatialFit& fit);

}  // namespace fathom
