#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/calibration.h"
#include "segmentation/contours.h"
#include "sim/simulated_tracker.h"
#include "sim/speckle.h"

namespace fathom {

struct Phantom;

/// A scan of an object of known volume with a simulated probe and tracker.
struct SimulateOptions : TrackerOptions {
  /// 13 minutes at 25 frames a second; the true outlines of all are held in memory, 5 kB a frame.
  static constexpr int kMaxFrames = 20000;
  std::string object = "sphere";   ///< one of object_names(), sim/phantom.h
  std::string pattern = "linear";  ///< one of pattern_names(), sim/scan_plan.h
  int frames = 20;                 ///< 1 to kMaxFrames
  double jitter_mm = 0.0;          ///< unsteady hand, before the scan: uniform in +- on each of three axes
  double jitter_deg = 0.0;         ///< the same for azimuth, elevation and roll
  bool steady_ends = false;        ///< the hand is steady at each sweep's first and last frame, where it waits
  double misregister_mm = 0.0;     ///< errors of the recorded poses, after the scan: uniform in +- on each axis
  double misregister_deg = 0.0;
  /// B-scans with speckle, as a scanner shows them; else 255 inside the object and 0 outside. Its `seed` is not used:
  /// the texture follows `seed` above. Objects with a look of their own (Phantom::bodies) are shown as a Scene,
  /// whatever is asked for here.
  std::optional<SpeckleOptions> speckle;

  /// Throws Error, naming what there is to choose from, when a value is out of range.
  void check() const;
};

/// Everything about the object and the scan that a real examination would not tell.
struct SimulatedTruth {
  double volume_ml = 0.0;
  double surface_area_cm2 = 0.0;
  struct StructureTruth {
    std::string name;
    double volume_ml = 0.0;
  };
  std::vector<StructureTruth> structures;
};

/// What the scan gave, and the truth behind it.
struct SimulatedScan {
  std::unique_ptr<Recording> recording;  ///< B-scans are made when asked for
  Calibration calibration;               ///< the true one, latency included
  SimulatedTruth truth;
  std::vector<Structure> outlines;  ///< true outlines, not thresholded; extremities where a plane only touches
};

/// Throws Error as SimulateOptions::check; Cancelled.
SimulatedScan simulate(const SimulateOptions& options, const Progress& progress = {});

/// The same of a phantom of one's own, whatever `options.object` says. Patterns look for the phantom's name.
SimulatedScan simulate_phantom(const Phantom& phantom, const SimulateOptions& options, const Progress& progress = {});

/// The text of the truth file (docs/file-formats.md).
std::string truth_json(const SimulatedScan& scan, const SimulateOptions& options);

}  // namespace fathom
