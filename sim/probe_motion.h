#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "registration/calibration.h"
#include "registration/sweep.h"
#include "sim/scan_plan.h"
#include "sim/simulate.h"
#include "sim/simulated_tracker.h"

namespace fathom {

/// A scan's planes as they were and as the tracker reports them, frame by frame.
struct ProbeMotion {
  std::vector<Eigen::Affine3d> phantom_from_image;  ///< true
  TrackedPoses tracked;                             ///< misregistered, late, and as the tracker spoils them
  std::vector<Sweep> sweeps;                        ///< the frames of each of the plan's
};

/// The simulated probe's own calibration: turned, 100 mm from the sensor to the image's centre, image x and y scaled by
/// the pixels' size. `latency_s` is copied.
Calibration simulated_calibration(const Eigen::Vector2d& pixel_mm, cv::Size image_size, double latency_s);

/// Moves the probe along the plan's sweeps, equal steps in time and a pause between sweeps. Jitter displaces the true
/// planes, in between frames by linear interpolation; what the tracker stamps t is the pose at t - latency_s, for which
/// the path goes on beyond its ends. `options` are checked. Throws Error as frames_of_sweeps.
ProbeMotion move_probe(const ScanPlan& plan, const Phantom& phantom, const Calibration& calibration,
                       const SimulateOptions& options);

}  // namespace fathom
