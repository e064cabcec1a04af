#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/studies/seen_target.h"

namespace fathom {

/// How large the errors of a system are. Defaults: what the study `chain` assumes.
struct ChainErrors {
  double tracker_mm = 0.25;  ///< 3D rms, and 0.6 degrees for each mm
  double outline_mm = 0.3;   ///< standard deviation, the same all around an outline, from section to section by chance
  double latency_s = 0.12;   ///< of the tracker's stamps, to be found
  /// The phantom's points are the true ones, each so far off on each axis; empty: they are found in images.
  std::optional<double> drawn_px;
};

/// What brings a volume's error about.
enum class ChainLink { kSections, kTracker, kCalibration, kLatency, kOutlining, kPixels };
inline constexpr std::array<const char*, 6> kChainLinks = {"sections", "tracker",   "calibration",
                                                           "latency",  "outlining", "pixels"};

/// An organ and how it is scanned.
struct ChainScan {
  std::string object;
  std::string pattern;
};

/// One organ measured by one system. Volumes are by quadric planimetry; NaN where there is none.
struct ChainVolumes {
  double true_ml = 0.0;
  /// Of each link alone, in the order of kChainLinks; all but the first also have what the sections do.
  std::array<double, kChainLinks.size()> link_ml{};
  double all_ml = 0.0;
  double all_but_outlining_ml = 0.0;
  double all_cubic_ml = 0.0;  ///< by 2D cubic planimetry
  double low_ml = 0.0;        ///< 95 % interval about all_ml, from what the system knows of its errors
  double high_ml = 0.0;
};

/// A system: a probe whose calibration was found from images of a wire phantom, with the latency, by a tracker with
/// noise. The phantom is registered. 10 s of scan, every fourth image looked at.
class MeasuringSystem {
 public:
  /// Throws Error as SeenTarget::found_in_images and calibrated.
  MeasuringSystem(const ChainErrors& errors, std::uint64_t seed);

  double point_mm() const { return point_mm_; }  ///< of the calibration, rms over the image
  double latency_error_s() const { return latency_error_s_; }

  /// Scans an organ with the same tracker, outlines `sections` of its images evenly from the first to the last that
  /// show it, and measures. The true outlines are known to 1e-4 of their area.
  ChainVolumes measure(const ChainScan& scan, int sections, std::uint64_t seed) const;

 private:
  /// The calibration found, for images of another size and depth by the same probe.
  Calibration carried_to(const Calibration& truth) const;

  ChainErrors errors_;
  Calibration truth_;
  Calibration found_;
  double point_mm_ = 0.0;
  double latency_error_s_ = 0.0;
};

}  // namespace fathom
