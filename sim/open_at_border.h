#pragma once

#include <Eigen/Geometry>

#include "segmentation/contours.h"

namespace fathom {

/// What is drawn of an outline that lies within a window: the whole, or, where runs of its edges lie on the window's
/// border, an open line without the longest of them, from the end of that run to its beginning. Points on the border
/// lie on it to 1e-6 pixels. The outline has at least three points.
Contour opened_at_border(Polygon outline, const Eigen::AlignedBox2d& window);

}  // namespace fathom
