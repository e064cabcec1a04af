#pragma once

#include <Eigen/Core>

namespace fathom {

/// What scanners take for the speed of sound in tissue when they turn a delay into a depth.
inline constexpr double kTissueSoundSpeed_m_s = 1540.0;

/// Speed of sound in pure water at normal pressure, to 0.05 m/s. Throws Error outside of 0 to 95 degrees.
/// Marczak 1997, JASA 102, 2776: a polynomial of fifth degree fitted to three sets of measurements.
double water_sound_speed_m_s(double celsius);

/// Echoes from water are shown too deep (the scanner takes sound to be faster than it is). This moves a pixel to where
/// the same distance is shown in tissue. Only the depth changes: y from the row of the transducer's face.
struct DepthCorrection {
  double face_row_px = 0.0;  ///< where depth is 0
  double factor = 1.0;       ///< depth in tissue over depth in the medium scanned

  Eigen::Vector2d operator()(const Eigen::Vector2d& pixel_px) const {
    return {pixel_px.x(), face_row_px + factor * (pixel_px.y() - face_row_px)};
  }
};

/// That of a water bath. Throws Error as water_sound_speed_m_s.
DepthCorrection water_correction(double celsius, double face_row_px = 0.0);

}  // namespace fathom
