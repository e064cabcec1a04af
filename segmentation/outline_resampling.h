#pragma once

#include "segmentation/contours.h"

namespace fathom {

double perimeter(const Polygon& outline);

/// Points at equal distances along a closed outline, about `spacing_px` apart, `least` at least; from the same first
/// point on.
Polygon resampled(const Polygon& outline, double spacing_px, int least);

/// Every point becomes a quarter of each neighbour and half of itself, so many times. Area shrinks where the outline
/// bends.
Polygon smoothed(Polygon outline, int passes);

}  // namespace fathom
