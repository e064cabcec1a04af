#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "measurement/section_raster.h"

namespace fathom {

/// Units of a chamfer code: a step to a neighbour across an edge of a cell, and to one across its corner.
inline constexpr int kChamferStep = 10;
inline constexpr int kChamferDiagonal = 14;

/// The code of a point beside the outline, which runs half-way between it and its neighbour.
inline constexpr int kChamferBorder = 5;

/// Length of the shortest path of straight and diagonal steps, in chamfer units, across `i` by `j` cells. Treece 2000,
/// equation (3.1).
inline float chamfer_length(float i, float j) {
  constexpr auto kStep = static_cast<float>(kChamferStep);
  constexpr auto kTurn = static_cast<float>(kChamferDiagonal - kChamferStep);
  const float x = std::abs(i);
  const float y = std::abs(j);
  return std::max(kStep * x + kTurn * y, kStep * y + kTurn * x);
}

/// Distances from the outline in chamfer units, without sign, from which points of a raster lie inside (1) or outside
/// (0). Where all points are alike they have no outline and get 32 753. Treece 2000, section 3.2.2.
std::vector<std::int16_t> chamfer_codes(const std::vector<std::uint8_t>& inside, const SectionRaster& raster);

}  // namespace fathom
