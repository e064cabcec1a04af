#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measurement/partition_volume.h"
#include "registration/division.h"
#include "sim/simulate.h"

namespace fathom {

/// A simulated scan, its sweeps as found, and the dividing planes placed between them.
struct DividedScan {
  SimulatedScan scan;
  FrameLocator locator;
  Division division;
};

/// Throws Error as simulate, find_sweeps and place_dividing_planes.
DividedScan divided_scan(const SimulateOptions& options);

/// How much of the straight line between an open contour's ends lies where its own sweep is used, the largest of all
/// contours: part of the object is missing there, beyond the image's border.
double cut_off_mm(const DividedScan& divided);

/// What one number of frames gives.
struct SweepsMeasurement {
  int frames = 0;
  int sections = 0;  ///< frames with a part of the object where their sweep is used: those that a person would outline
  double linear_percent = 0.0;  ///< signed errors of the volume; not a number where there is no volume
  double cubic_percent = 0.0;
  double quadric_percent = 0.0;
  /// Of the outlines that the image's border cuts, where this sweep is used: largest length of border within the
  /// object. Above 0 the images do not show all that is to be measured in them.
  double cut_off_mm = 0.0;
  double missing_percent = 0.0;  ///< what measure_partitions estimates to be missing, of the true volume
};

SweepsMeasurement measure_sweeps(const std::string& object, const std::string& pattern, int frames);

/// Signed error of the volume of the surfaces by maximal discs, of second order, that dividing planes cut; not a number
/// where there is none. Throws Error as divided_scan.
double surface_error_percent(const std::string& object, const std::string& pattern, int frames);

/// One cell of Treece 2000, table 4.1.
struct SweepsCell {
  std::string object;
  std::string pattern;
  int published_sections = 0;     ///< "< n" as n
  double published_linear = 0.0;  ///< "> n" as n; no sign is printed
  double published_surface = 0.0;
  std::vector<SweepsMeasurement> measurements;  ///< of every number of frames within the limits
  /// The fewest frames with which these and all larger numbers keep cubic planimetry within 2 %.
  std::optional<SweepsMeasurement> sustained;
  std::optional<SweepsMeasurement> sustained_quadric;  ///< the same of quadric planimetry
  /// The measurement whose number of sections is nearest to the published one.
  SweepsMeasurement at_published;
  double surface_percent = 0.0;  ///< of the same scan, as surface_error_percent
};

inline constexpr int kFewestPerSweep = 4;
inline constexpr int kMostPerSweep = 23;

/// Object and pattern of all 32 cells, with the published figures.
std::vector<SweepsCell> published_sweeps_cells();

/// Scans and measures. Takes object, pattern and the published figures from `cell`.
SweepsCell measure_sweeps_cell(const SweepsCell& cell);

/// Fills `sustained`, `sustained_quadric` and `at_published` from the measurements, of which there must be some.
void summarise(SweepsCell& cell);

}  // namespace fathom
