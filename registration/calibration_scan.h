#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/sound_speed.h"
#include "registration/spatial_calibration.h"
#include "registration/target_errors.h"
#include "registration/wall_detection.h"
#include "registration/wire_phantom.h"

namespace fathom {

/// What stands in the water bath.
struct CalibrationPhantom {
  CalibrationTarget target = CalibrationTarget::kWires;
  WirePhantom wires;  ///< where the target is wires
};

/// "wall" (a flat floor), "point" (a bead or crossed wires), or a file that read_wire_phantom reads. Throws Error.
CalibrationPhantom calibration_phantom(const std::string& what, const std::optional<std::string>& reference_frame);

/// A recording of a phantom: where the probe was, and what the images show of the phantom.
struct CalibrationScan {
  CalibrationScan(ProbePoses probe_poses, cv::Size size) : poses(std::move(probe_poses)), image_size(size) {}

  ProbePoses poses;
  cv::Size image_size;
  std::vector<WirePoint> wires;
  std::optional<bool> wire_0_left;  ///< of every pattern, in the images
  /// The images do not tell which wire of an N is wire 0: swapping wires 0 and 2 everywhere is as good.
  bool side_unknown = false;
  std::vector<WallLine> lines;
  std::vector<SpotPoint> points;
  int frames_with_target = 0;
};

struct CalibrationScanOptions {
  DepthCorrection depth;            ///< applied to all pixels found
  std::optional<bool> wire_0_left;  ///< where it is known; see WireDetectionOptions
};

/// Looks for the phantom in every frame. Throws Error where it is not seen; Cancelled.
CalibrationScan scan_phantom(const Recording& recording, const PoseChain& chain, const CalibrationPhantom& phantom,
                             const CalibrationScanOptions& options, const Progress& progress = {});

/// What may be fitted, and to what.
struct ScanFitOptions {
  bool try_latency = true;
  bool try_skew = true;
  double max_latency_s = 0.7;
  bool estimate_phantom = false;  ///< the wires' registration, though the phantom states it
};

/// Calibrates from a scan. Where the images leave open which side of the wires is seen, both are tried; the scan then
/// keeps the side that fits. Throws Error as calibrate_with_wires, calibrate_with_wall, calibrate_with_point.
SpatialFit calibrate_scan(CalibrationScan& scan, const CalibrationPhantom& phantom, const ScanFitOptions& options);

/// How far a calibration is off in a scan: its own, or another of the same phantom in the same place.
struct ScanErrors : TargetErrors {
  std::optional<double> wire_mean_mm;  ///< of all points from their wires' lines, where there are wires
  std::optional<double> wire_rms_mm;
};
ScanErrors scan_errors(const CalibrationScan& scan, const CalibrationPhantom& phantom, const SpatialState& state);

/// Where one thing seen is put, for pictures.
struct Residual {
  int frame = 0;
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
  std::string part;  ///< the wire's name; "floor", "point"
  double distance_mm = 0.0;
};

/// In order of the scan; frames without a pose are left out.
std::vector<Residual> residuals(const CalibrationScan& scan, const CalibrationPhantom& phantom,
                                const SpatialState& state);

}  // namespace fathom
