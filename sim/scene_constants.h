#pragma once

#include "sim/speckle.h"

// How scenes look. These are the conditions under which outlining is judged: they were fixed before any method was
// tried on them and are not tuned to any.

namespace fathom::scene {

/// Of every structure against the tissue around it, darker or brighter.
inline constexpr double kContrast_db = 6.0;
/// Share of the structures' surface at which nothing is seen of it.
inline constexpr double kDropout = 0.20;

// Places without an outline.
inline constexpr double kDropoutWave_mm = 30.0;  ///< shortest wave of the pattern that says where they are
inline constexpr double kDropoutBand_mm = 4.0;   ///< how deep one side's echoes spread into the other there
inline constexpr double kDropoutFade = 0.1;      ///< of the pattern's threshold, within which the outline fades

// What lies behind something, along the beam.
inline constexpr double kEnhancement_db_per_mm = 0.12;  ///< of fluid
inline constexpr double kBone_db_per_mm = -0.12;        ///< of a body with bones in it
inline constexpr double kMostBehind_db = 12.0;          ///< either way
inline constexpr int kShadows = 2;                      ///< small bodies between probe and object that cast shadows
inline constexpr double kShadow_db = -8.0;              ///< behind the middle of one
inline constexpr double kShadowEcho_db = 8.0;           ///< of the body itself against tissue
inline constexpr double kShadowRadius = 0.07;           ///< of such a body, as a share of the object's radius

/// A 3.5 MHz probe at abdominal depth.
inline SpeckleOptions speckle(std::uint64_t seed) {
  SpeckleOptions options;
  options.lateral_mm = 1.8;
  options.axial_mm = 0.8;
  options.elevation_mm = 3.0;
  options.seed = seed;
  return options;
}

}  // namespace fathom::scene
