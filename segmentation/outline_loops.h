#pragma once

#include "segmentation/contours.h"

namespace fathom {

/// Area of a closed outline: positive where it runs clockwise as seen on the screen (y runs down).
double signed_area(const Polygon& outline);

/// The outline without points that repeat the one before; the last is before the first.
Polygon without_repeats(const Polygon& outline);

/// The outline without the loops that it ties where it crosses itself: of every two parts that a crossing makes, the
/// one of larger area stays. Points that repeat are dropped. Time grows with the square of the number of points.
Polygon without_loops(Polygon outline);

}  // namespace fathom
