#include "registration/calibration_scan.h"

#include <array>

#include "core/error.h"
#include "registration/point_calibration.h"
#include "registration/spatial_calibration_errors.h"
#include "registration/wall_calibration.h"
#include "registration/wire_calibration.h"
#include "registration/wire_detection.h"
#include "registration/wire_phantom_file.h"

namespace fathom {

namespace {

void scan_wires(CalibrationScan& scan, const Recording& recording, const CalibrationPhantom& phantom,
                const CalibrationScanOptions& options, const Progress& progress) {
  WireDetectionOptions detection;
  detection.wire_0_left = options.wire_0_left;
  WireDetection found = find_wires(recording, phantom.wires, detection, progress);
  scan.side_unknown = found.side_unknown;
  scan.wire_0_left = found.wire_0_left;
  scan.frames_with_target = found.frames_with_wires();
  scan.wires = std::move(found.points);
  for (WirePoint& point : scan.wires) point.position_px = options.depth(point.position_px);
}

void scan_wall(CalibrationScan& scan, const Recording& recording, const CalibrationPhantom&,
               const CalibrationScanOptions& options, const Progress& progress) {
  scan.lines = detect_wall(recording, {}, progress);
  scan.frames_with_target = static_cast<int>(scan.lines.size());
  for (WallLine& line : scan.lines) {
    const Eigen::Vector2d end = options.depth(line.point_px + line.reach_px * line.direction);
    line.point_px = options.depth(line.point_px);
    line.reach_px = (end - line.point_px).norm();
    if (line.reach_px > 0.0) line.direction = (end - line.point_px) / line.reach_px;
  }
}

void scan_point(CalibrationScan& scan, const Recording& recording, const CalibrationPhantom&,
                const CalibrationScanOptions& options, const Progress& progress) {
  constexpr double kRival = 0.8;
  scan.points = detect_point(recording, {}, kRival, progress);
  scan.frames_with_target = static_cast<int>(scan.points.size());
  for (SpotPoint& point : scan.points) point.position_px = options.depth(point.position_px);
}

void swap_sides(std::vector<WirePoint>& points) {
  for (WirePoint& point : points) point.wire = 2 - point.wire;
}

void allow(SpatialOptions& spatial, const ScanFitOptions& options) {
  spatial.try_latency = options.try_latency;
  spatial.try_skew = options.try_skew;
  spatial.max_latency_s = options.max_latency_s;
}

SpatialFit calibrate_wires(CalibrationScan& scan, const WirePhantom& phantom, const WireCalibrationOptions& options) {
  if (!scan.side_unknown) return calibrate_with_wires(scan.poses, scan.wires, phantom, options);
  std::vector<WirePoint> swapped = scan.wires;
  swap_sides(swapped);
  std::optional<SpatialFit> first;
  std::string fault;
  try {
    first = calibrate_with_wires(scan.poses, scan.wires, phantom, options);
  } catch (const Error& error) {
    fault = error.what();
  }
  try {
    SpatialFit second = calibrate_with_wires(scan.poses, swapped, phantom, options);
    if (!first || second.rms_mm < first->rms_mm) {
      scan.wires = std::move(swapped);
      scan.wire_0_left = !*scan.wire_0_left;
      return second;
    }
  } catch (const Error&) {
    if (!first) throw Error(fault);
  }
  return *first;
}

// Observations and names of what a wall or a point gave.
struct Seen {
  std::vector<SpatialObservation> observations;
  const char* part;
};

Seen seen_of(const CalibrationScan& scan, CalibrationTarget target) {
  if (target == CalibrationTarget::kWall) return {wall_observations(scan.lines), "floor"};
  return {point_observations(scan.points), "point"};
}

}  // namespace

CalibrationPhantom calibration_phantom(const std::string& what, const std::optional<std::string>& reference_frame) {
  CalibrationPhantom phantom;
  if (what == "wall") {
    phantom.target = CalibrationTarget::kWall;
  } else if (what == "point") {
    phantom.target = CalibrationTarget::kPoint;
  } else {
    phantom.wires = read_wire_phantom(what, reference_frame);
  }
  return phantom;
}

CalibrationScan scan_phantom(const Recording& recording, const PoseChain& chain, const CalibrationPhantom& phantom,
                             const CalibrationScanOptions& options, const Progress& progress) {
  const RecordingHeader& header = recording.header();
  CalibrationScan scan(probe_poses(recording, chain), cv::Size(header.width, header.height));
  if (scan.poses.valid_count() == 0) {
    throw Error(recording.name() + ": has no valid pose of " + chain.probe + " in " + chain.reference +
                "; record again with the probe's sensor in the tracker's view");
  }
  using Scanning = void (*)(CalibrationScan&, const Recording&, const CalibrationPhantom&,
                            const CalibrationScanOptions&, const Progress&);
  constexpr std::array<Scanning, 3> kScannings = {scan_wires, scan_wall, scan_point};
  kScannings[static_cast<std::size_t>(phantom.target)](scan, recording, phantom, options, progress);
  return scan;
}

SpatialFit calibrate_scan(CalibrationScan& scan, const CalibrationPhantom& phantom, const ScanFitOptions& options) {
  if (phantom.target == CalibrationTarget::kWires) {
    WireCalibrationOptions wires;
    allow(wires.spatial, options);
    WirePhantom wire_phantom = phantom.wires;
    if (options.estimate_phantom) wire_phantom.reference_from_phantom.reset();
    return calibrate_wires(scan, wire_phantom, wires);
  }
  const bool wall = phantom.target == CalibrationTarget::kWall;
  SpatialOptions spatial = wall ? wall_options() : point_options();
  allow(spatial, options);
  return wall ? calibrate_with_wall(scan.poses, scan.lines, spatial)
              : calibrate_with_point(scan.poses, scan.points, spatial);
}

ScanErrors scan_errors(const CalibrationScan& scan, const CalibrationPhantom& phantom, const SpatialState& state) {
  ScanErrors errors;
  TargetErrors& common = errors;
  if (phantom.target == CalibrationTarget::kWires) {
    const WireErrors wires = wire_errors(scan.poses, scan.wires, phantom.wires, state);
    common = wires;
    errors.wire_mean_mm = wires.wire_mean_mm;
    errors.wire_rms_mm = wires.wire_rms_mm;
  } else {
    common = observed_errors(scan.poses, seen_of(scan, phantom.target).observations, state);
  }
  return errors;
}

std::vector<Residual> residuals(const CalibrationScan& scan, const CalibrationPhantom& phantom,
                                const SpatialState& state) {
  const bool wires = phantom.target == CalibrationTarget::kWires;
  Seen seen;
  if (wires) {
    WireCalibrationOptions across;
    across.along_weight = 0.0;  // distances to the wires alone can be told apart by wire
    seen = {wire_observations(scan.wires, phantom.wires, across), ""};
  } else {
    seen = seen_of(scan, phantom.target);
  }
  const SpatialErrors errors = spatial_errors(scan.poses, seen.observations, state);
  std::vector<Residual> list;
  for (std::size_t i = 0; i < seen.observations.size(); ++i) {
    if (!errors.inside[i]) continue;
    const SpatialObservation& observation = seen.observations[i];
    const std::string part =
        wires ? phantom.wires.patterns.at(scan.wires[i].pattern).at(scan.wires[i].wire).name : seen.part;
    list.push_back({observation.frame, observation.position_px, part, errors.error_mm[i].norm()});
  }
  return list;
}

}  // namespace fathom
