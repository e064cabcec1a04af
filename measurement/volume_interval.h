#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "measurement/cross_section.h"
#include "registration/calibration.h"

namespace fathom {

/// How far outlines and poses may be off, as far as known. All are standard deviations.
struct MeasurementErrors {
  /// Of an outline from the organ's true border, the same all around it, from section to section by chance. Empty: the
  /// scatter is judged from how unevenly the sections follow each other.
  std::optional<double> outline_mm;
  double tracker_mm = 0.0;   ///< of the probe's position, root mean square in space, from frame to frame by chance
  double tracker_deg = 0.0;  ///< of its orientation, root mean square in space
  /// Throws Error unless all are finite and not negative.
  void check() const;
};

/// A volume with its 95 % interval, and what each source of error has to do with it (standard deviations).
struct VolumeInterval {
  double low_ml = 0.0;  ///< never below 0
  double high_ml = 0.0;
  double spacing_ml = 0.0;      ///< by what lies between sections; with the scatter of outlines where that is judged
  double outlining_ml = 0.0;    ///< by the given scatter of outlines
  double tracker_ml = 0.0;      ///< by the given noise of the tracker
  double calibration_ml = 0.0;  ///< by the covariance of the calibration, where it has one
};

/// Three parabola points are met exactly, whatever the organ: fewer sections do not tell how smooth it is.
inline constexpr std::size_t kFewestForInterval = 4;

/// What an interval is made of, in mm6.
struct VolumeVariances {
  double left_out_mm6 = 0.0;   ///< sum of the squares of the changes when each inner section in turn is left out
  double outlining_mm6 = 0.0;  ///< variance by the given scatter of outlines
  double tracker_mm6 = 0.0;    ///< variance by the given noise of the tracker
};

/// Spacing is a quarter of the root of what is left out beyond the variances; where the scatter of outlines is not
/// known, all of it is scatter.
VolumeInterval interval_about(double volume_ml, const VolumeVariances& found, bool outline_known,
                              double calibration_ml);

/// What errors of a section act on.
struct SectionPlace {
  double perimeter_mm = 0.0;
  Eigen::Vector3d probe_mm = Eigen::Vector3d::Zero();  ///< the sensor, in reference coordinates
};

/// The interval about quadric planimetry of `sections`; `places` has one entry for each of them. `calibration_ml` as
/// calibration_spread_ml (measurement/calibration_spread.h). Empty with fewer than four sections, which do not tell how
/// smooth the organ is, and where planimetry has no volume.
///
/// Outlining and tracker: first order propagation through equation (2.2), in which each section's area and centroid
/// weigh by the way, or the areas, of its neighbours. Spacing: a quarter of the root sum of squares of what the volume
/// changes by when each inner section in turn is left out; the share was found on simulated scans (docs/results.md).
std::optional<VolumeInterval> volume_interval(std::span<const CrossSection> sections,
                                              std::span<const SectionPlace> places, const MeasurementErrors& errors,
                                              double calibration_ml = 0.0);

/// Perimeters and sensor positions for `sections`, which are those of `structure`. `calibration` is the locator's.
std::vector<SectionPlace> section_places(const Structure& structure, std::span<const CrossSection> sections,
                                         const FrameLocator& locator, const Calibration& calibration);

}  // namespace fathom
