#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "core/random.h"

namespace fathom {

/// Errors of a simulated tracker; part of the options of every simulated scan.
struct TrackerOptions {
  /// Larger disturbances are typing errors.
  static constexpr double kMaxShift_mm = 1000.0;
  static constexpr double kMaxTurn_deg = 180.0;
  static constexpr double kMaxLatency_s = 10.0;  ///< either way

  std::uint64_t seed = 1;  ///< of everything random in the scan: the same seed gives the same bytes
  double noise_mm = 0.0;   ///< Gaussian: 3D rms in position
  double noise_deg = 0.0;  ///< 3D rms in orientation
  double latency_s = 0.0;  ///< the tracker's stamps lag the image's by this much
  double outliers = 0.0;   ///< share of the poses that are wrong, by centimetres and some degrees, but marked valid
  double dropouts = 0.0;   ///< share of the poses that the tracker lost, some in a row, and marks invalid

  /// Throws Error when a value is out of range.
  void check() const;
};

/// Throws Error: "simulate: the noise cannot be -1; choose from 0 to 1000 mm", unless `value` is in the range.
void require_within(const char* what, double value, double low, double high, const char* unit);

inline constexpr double kFrameRate_hz = 25.0;
inline constexpr double kFirstTime_s = 3.52;  ///< a recording seldom starts with the clock

/// What "0.25 mm of noise" means for orientation: 0.15 degrees (Treece 2000).
inline constexpr double kTurnOfNoise_deg_per_mm = 0.6;

/// A vector whose components are Gaussian with this standard deviation.
Eigen::Vector3d gaussian_vector(Random& random, double sigma);

/// A pose as a tracker with noise gives it: shifted and turned by Gaussian errors on and about each axis.
void displace(Eigen::Isometry3d& pose, double mm, double rad, Random& random);

/// The pose that turns about `turn_rad`'s direction by its length, then shifts.
Eigen::Isometry3d placed(const Eigen::Vector3d& turn_rad, const Eigen::Vector3d& place_mm);

/// Where the reference's sensor is in every simulated scan, and where objects stand relative to it unless they say.
Eigen::Isometry3d simulated_tracker_from_reference();
Eigen::Isometry3d simulated_reference_from_phantom();

/// What a tracker made of true poses: one a frame.
struct TrackedPoses {
  std::vector<double> times_s;
  std::vector<Eigen::Isometry3d> tracker_from_probe;
  std::vector<bool> wrong;  ///< outliers
  std::vector<bool> lost;   ///< dropouts, marked invalid
};

/// Adds the tracker's noise to poses, and marks and spoils those that are to be lost or wrong. Every disturbance has
/// random numbers of its own, so that switching one on leaves the others as they were.
TrackedPoses track(std::vector<double> times_s, std::vector<Eigen::Isometry3d> tracker_from_probe,
                   const TrackerOptions& options);

/// The header of a recording of 8-bit images with these poses, as "ProbeToTracker" and "ReferenceToTracker".
RecordingHeader tracked_header(const TrackedPoses& poses, int width, int height);

}  // namespace fathom
