#pragma once

#include <Eigen/Core>

namespace fathom {

/// On which side of the line from `a` to `b` the point `c` lies: +1 to the left, -1 to the right, 0 on it. Exact for
/// the coordinates as given, unless products of them underflow.
int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// On which side of the plane through `a`, `b` and `c` the point `d` lies: +1 where they are seen counter-clockwise,
/// -1 on the other side, 0 in it. Exact as above.
int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d);

/// The first of these without its exact part: 0 also when the sign is in doubt.
int certain_orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace fathom
