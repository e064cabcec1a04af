#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace fathom {

// Cutting by planes: polygons in a plane, lines, and convex bodies. Positive is the side that a plane's normal points
// to.

using Polygon3 = std::vector<Eigen::Vector3d>;

/// The area of a closed polygon as a vector along its normal (right-hand rule). `polygon` lies in a plane and may have
/// any shape.
Eigen::Vector3d vector_area(const Polygon3& polygon);

/// Where a plane meets the edge between a point `above` mm on its positive side and one `below` mm, negative, on the
/// other. The same for both who share the edge, so that neighbouring parts have the point exactly in common.
inline Eigen::Vector3d plane_crossing(const Eigen::Vector3d& positive, double above, const Eigen::Vector3d& negative,
                                      double below) {
  return (positive * -below + negative * above) / (above - below);
}

/// The two parts of a closed polygon. A polygon that is not convex may come back as one part joined along the plane, to
/// and fro, which has the right area and centroid. A point on the plane belongs to both parts; a part without points
/// off the plane is empty.
struct SplitPolygon {
  Polygon3 positive;
  Polygon3 negative;
};
SplitPolygon split_polygon(const Polygon3& polygon, const Eigen::Hyperplane<double, 3>& plane);

/// The part of a closed polygon on the positive side of all `planes`.
Polygon3 clip_polygon(Polygon3 polygon, const std::vector<Eigen::Hyperplane<double, 3>>& planes);

/// The pieces of an open line on the positive side of all `planes`, in its order.
std::vector<Polygon3> clip_line(const Polygon3& line, const std::vector<Eigen::Hyperplane<double, 3>>& planes);

/// A convex body by its faces, which are convex polygons.
struct ConvexBody {
  std::vector<Polygon3> faces;
};

/// A cube about `centre_mm`.
ConvexBody make_cube(const Eigen::Vector3d& centre_mm, double half_size_mm);

/// Mean of the corners of all faces: a point inside.
Eigen::Vector3d middle(const ConvexBody& body);

/// The two parts of a body. A part that reaches less than `tolerance_mm` beyond the plane is empty and the other part
/// is the whole.
struct SplitBody {
  ConvexBody positive;
  ConvexBody negative;
};
SplitBody split_body(const ConvexBody& body, const Eigen::Hyperplane<double, 3>& plane, double tolerance_mm);

}  // namespace fathom
