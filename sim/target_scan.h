#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "registration/calibration.h"
#include "registration/wire_phantom.h"
#include "sim/simulated_tracker.h"

namespace fathom {

/// A scan of what a probe is calibrated with, in a simulated water bath.
struct TargetScanOptions : TrackerOptions {
  std::string object = "wires";       ///< one of target_names()
  WirePhantom phantom;                ///< where the object is wires
  std::string pattern = "calibrate";  ///< one of target_pattern_names()
  std::string probe = "linear";       ///< one of probe_names()
  int frames = 120;                   ///< 1 to SimulateOptions::kMaxFrames
  double away_mm = 0.0;               ///< the probe is held so much farther from the target

  /// Throws Error, naming what there is to choose from, when a value is out of range or the phantom is not usable.
  void check() const;
};

/// "wires" (a phantom's), "wall" (a flat floor), "point" (a bead or crossed wires).
std::vector<std::string> target_names();
/// "calibrate" (turns and moves all ways over the target), "floor" (up and down, for finding a latency), "still".
std::vector<std::string> target_pattern_names();
/// "linear", "curvilinear" (a fan on black).
std::vector<std::string> probe_names();

/// One thing that a frame truly shows.
struct TruePoint {
  int frame = 0;
  std::string name;  ///< the wire's; "point"; "left" and "right": the floor at the first and last column
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
};

struct SimulatedTargetScan {
  std::unique_ptr<Recording> recording;  ///< B-scans are made when asked for
  Calibration calibration;               ///< the true one, latency included
  /// Of the wires: the phantom's own registration where it has one, else that of every simulated scan. Of a floor: its
  /// surface is z = 0. A point is at the origin.
  Eigen::Isometry3d reference_from_phantom = Eigen::Isometry3d::Identity();
  std::vector<TruePoint> points;  ///< in order of frames; only what is in view
  int frames_in_view = 0;         ///< that show the whole target: all wires, the point, some of the floor
  std::vector<bool> wrong;        ///< frames whose pose is an outlier
  std::vector<bool> lost;         ///< frames whose pose is marked invalid
};

/// Throws Error as TargetScanOptions::check, and when no frame shows the whole target.
SimulatedTargetScan simulate_target(const TargetScanOptions& options);

/// The text of the truth file (docs/file-formats.md).
std::string truth_json(const SimulatedTargetScan& scan, const TargetScanOptions& options);

}  // namespace fathom
