#pragma once

#include <span>

#include <Eigen/Core>

#include "measurement/cross_section.h"

namespace fathom {

/// Steps between centroids that are shorter than this share of the whole path are none: at ten metres from the
/// origin the rounding of a position is a hundred thousand times smaller.
inline constexpr double kNoStep = 1e-9;

/// The unit vector that a section faces: along its vector area, or its frame's normal where it has no area.
inline Eigen::Vector3d facing(const CrossSection& section) {
  const double area = section.vector_area_mm2.norm();
  return area > 0.0 ? Eigen::Vector3d(section.vector_area_mm2 / area) : section.normal;
}

/// The way from centroid to centroid.
inline double path_length_mm(std::span<const CrossSection> sections) {
  double length = 0.0;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    length += (sections[i].centroid_mm - sections[i - 1].centroid_mm).norm();
  }
  return length;
}

}  // namespace fathom
