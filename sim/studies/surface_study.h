#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/progress.h"

namespace fathom {

/// How surfaces are interpolated, in the order of Treece 2000, table 2.1, columns 4 to 6, and by discs to second order,
/// with their names in results.
inline constexpr std::array<const char*, 4> kSurfaceMethods = {"shape_based", "centroid_guided", "disc_guided",
                                                               "disc_guided_curved"};

/// The volume of the surface through the true outlines of 20 planes.
struct SurfaceVolumeRow {
  std::string object;
  std::string pattern;
  std::array<double, 3> published_percent{};  ///< error at 20 planes
  std::array<double, 4> error_percent{};      ///< signed; NaN where there is no volume
  std::array<double, 4> seconds{};
  std::array<bool, 4> closed{};
  double radius_ratio_p95 = 0.0;  ///< of the disc-guided surface, as above_2
  double above_2 = 0.0;
};

/// The published surfaces were made at twice the pixel size.
inline constexpr double kSurfaceStudySpacing_mm = 0.24;
inline constexpr int kSurfaceStudyPlanes = 20;

/// Object and pattern of every row, with the published figures.
std::vector<SurfaceVolumeRow> published_surface_rows();

/// Scans, makes the four surfaces and measures them.
SurfaceVolumeRow measure_surface_row(const SurfaceVolumeRow& row);

/// As a table in Markdown, published figures in brackets.
std::string surface_table_text(const std::vector<SurfaceVolumeRow>& rows);

}  // namespace fathom
