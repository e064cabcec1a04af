#pragma once

#include <string>
#include <vector>

#include "registration/spatial_calibration.h"
#include "registration/target_errors.h"
#include "registration/wire_phantom.h"

namespace fathom {

/// How to calibrate from an N-wire phantom.
struct WireCalibrationOptions {
  SpatialOptions spatial;
  /// Weight of where along the middle wire its point lies, as the ratio of the three points tells, against distances
  /// to the wires. PLUS's metric counts it fully.
  double along_weight = 1.2;

  void check() const;
};

/// What the solver gets: an observation a point, across its wire, and along the middle wires where asked for.
std::vector<SpatialObservation> wire_observations(const std::vector<WirePoint>& points, const WirePhantom& phantom,
                                                  const WireCalibrationOptions& options);

/// Calibrates from points of wires in frames. The phantom's pose is estimated where the phantom does not state it.
/// Throws Error when there are too few frames, the motion is too poor, or the points are not those of this phantom; it
/// says so where they are those of the phantom in another place, or of its mirror image.
SpatialFit calibrate_with_wires(const ProbePoses& poses, const std::vector<WirePoint>& points,
                                const WirePhantom& phantom, const WireCalibrationOptions& options = {});

/// Of the middle points by PLUS's metric (see TargetErrors), and of all points from their wires' lines.
struct WireErrors : TargetErrors {
  double wire_mean_mm = 0.0;
  double wire_rms_mm = 0.0;
};

/// `state` holds the phantom's pose too. Frames without a pose are left out. Throws Error when none is left.
WireErrors wire_errors(const ProbePoses& poses, const std::vector<WirePoint>& points, const WirePhantom& phantom,
                       const SpatialState& state);

}  // namespace fathom
