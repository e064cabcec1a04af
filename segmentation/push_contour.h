#pragma once

#include <Eigen/Core>

#include "segmentation/contours.h"

namespace fathom {

/// Pushes a line with a round brush: points inside of the circle about `centre_px` go straight out to its edge, and
/// where the line is too coarse to follow the edge it gets more points, no farther apart than a quarter of the radius.
/// `centre_px` and `radius_px` > 0 are in pixels. Returns false, with the line as it was, where the brush does not
/// touch it.
///
/// A brush whose centre comes from inside of a closed line pushes it outward, one from outside inward. A brush that
/// jumps across the line would turn it over: move it by less than its radius at a time.
bool push_contour(const Eigen::Vector2d& centre_px, double radius_px, bool closed, Polygon& points_px);

}  // namespace fathom
