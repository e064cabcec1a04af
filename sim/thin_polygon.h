#pragma once

#include "segmentation/contours.h"

namespace fathom {

/// Leaves out points where a polygon is nearly straight: no line of the result passes farther than `tolerance_of_area`
/// times area / perimeter from the points left out, so that the area changes by no more than that share of itself.
/// Corners stay. `line` has at least three points.
Polygon thinned(const Polygon& line, double tolerance_of_area);

}  // namespace fathom
