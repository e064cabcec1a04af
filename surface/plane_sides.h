#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "surface/mesh.h"

namespace fathom {

/// On which side of a plane the vertices of a mesh lie. What touches the plane is positive where it hangs together,
/// along edges on the plane, with what is; so no edge leads from a positive vertex on the plane to a negative one on
/// it.
struct PlaneSides {
  std::vector<double> distances_mm;  ///< 0 for a vertex that lies on the plane to 16 units in the last place
  std::vector<char> positive;
  bool any_touching = false;
};

PlaneSides plane_sides(const Mesh& mesh, const Eigen::Hyperplane<double, 3>& plane);

}  // namespace fathom
