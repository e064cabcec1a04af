#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "registration/calibration_scan.h"
#include "sim/target_scan.h"

namespace fathom {

/// The phantom of PLUS's recordings: three Ns, 30 mm wide, 40 mm long and 20 mm high, that look different from behind;
/// registered.
WirePhantom three_n_phantom();

/// A simulated scan of `object` (see target_names) with this phantom where it is wires.
TargetScanOptions target_scan_of(const std::string& object, int frames, std::uint64_t seed);

/// What calibrates with such a scan.
CalibrationPhantom calibration_phantom_of(const TargetScanOptions& options);

/// rms distance between where two calibrations put the pixels of a grid over the image, in mm.
double point_error_mm(const Calibration& truth, const Eigen::Affine3d& probe_from_image);

/// How a calibration came out, beside the truth.
struct CalibrationTrial {
  double point_mm = 0.0;       ///< point_error_mm
  double stated_mm = 0.0;      ///< largest standard deviation of a pixel's place that the fit states
  double latency_s = 0.0;      ///< error
  Eigen::VectorXd normalised;  ///< errors of the calibration's own fitted parameters, in standard deviations stated
};

/// What a simulated scan shows of its target, to be calibrated from with one tracker after another: what is seen does
/// not depend on the tracker.
class SeenTarget {
 public:
  /// As found in every `step`th image; in so many images the target must be looked for. Throws Error as simulate_target
  /// and scan_phantom.
  static SeenTarget found_in_images(const TargetScanOptions& options, int step);

  /// As the scan truly shows it, each point off by `noise_px` on each axis.
  static SeenTarget drawn(const TargetScanOptions& options, double noise_px, std::uint64_t seed);

  int frames_seen() const { return seen_.frames_with_target; }

  /// With poses of a tracker with noise (3D rms; 0.6 degrees for each mm, Treece 2000). Throws Error as calibrate_scan.
  CalibrationTrial calibrated(double noise_mm, std::uint64_t tracker_seed, const ScanFitOptions& fitting) const;

  /// The calibration itself.
  SpatialFit fitted(double noise_mm, std::uint64_t tracker_seed, const ScanFitOptions& fitting) const;
  const Calibration& truth() const { return truth_; }

 private:
  SeenTarget(const TargetScanOptions& options, const SimulatedTargetScan& scan, CalibrationScan seen);

  CalibrationPhantom phantom_;
  Calibration truth_;
  CalibrationScan seen_;  ///< with exact poses
};

}  // namespace fathom
