#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "sim/solid.h"

namespace fathom {

/// Where a plane that comes from outside first meets a part of a solid.
struct PartContact {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  bool on_face = false;  ///< a flat face of the solid lies in the plane
  bool whole = false;    ///< the plane touches the whole solid, not only the part
};

/// What of a solid lies in some convex cells of space, or all of it. Refers to the solid.
class SolidPart {
 public:
  using Cell = std::vector<Eigen::Hyperplane<double, 3>>;  ///< on the positive side of all

  explicit SolidPart(const Solid& solid) : solid_(&solid) {}
  SolidPart(const Solid& solid, std::vector<Cell> cells) : solid_(&solid), cells_(std::move(cells)), is_whole_(false) {}

  bool is_whole() const { return is_whole_; }

  /// The point that lies farthest along `direction` (a unit vector): exact where that is the whole solid's, else within
  /// a tenth of `inset_mm()` below it. The middle of the solid's extents where the part is empty.
  PartContact contact(const Eigen::Vector3d& direction) const;

  /// A hundredth of the solid's radius: how far a plane reaches into the part that is close to its edge.
  double inset_mm() const;

 private:
  double distance_bound_mm(const Eigen::Vector3d& x_mm) const;

  const Solid* solid_;
  std::vector<Cell> cells_;
  bool is_whole_ = true;
};

}  // namespace fathom
