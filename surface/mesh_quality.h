#pragma once

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// How near a triangle is to an equilateral one. A triangle that is less than 1e-12 as high as it is long counts as
/// having no area at all: then the radius ratio is infinite, `q_area` and the area are 0, and so is the smallest angle.
struct TriangleQuality {
  double radius_ratio = 1.0;  ///< R / (2 r), circumscribed to twice inscribed circle: 1 if equilateral, else more
  double smallest_angle_rad = 0.0;
  double largest_angle_rad = 0.0;
  double q_area = 1.0;  ///< 4 sqrt(3) area / sum of squared edges: 1 if equilateral, else less. De Bruin 2004, 4.2.3
  double area_mm2 = 0.0;
};

/// The triangle with corners `a`, `b` and `c`, in millimetres.
TriangleQuality triangle_quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// Quality over all triangles of a mesh, each counting once. A percentile p is the smallest value that at least p % of
/// the triangles do not exceed. Radius ratios are infinite from where triangles without area are reached.
struct MeshQuality {
  double radius_ratio_median = 0.0;
  double radius_ratio_p95 = 0.0;
  double radius_ratio_max = 0.0;
  double above_2 = 0.0;  ///< share of triangles with a radius ratio above 2, in [0, 1]
  double smallest_angle_rad = 0.0;
  double largest_angle_rad = 0.0;
  double q_area_p5 = 0.0;
  double q_area_median = 0.0;
  double q_area_mean = 0.0;
  int zero_area_triangles = 0;
};

/// `mesh` must be valid (see require_valid). Throws Error when it has no triangle.
MeshQuality mesh_quality(const Mesh& mesh);

}  // namespace fathom
