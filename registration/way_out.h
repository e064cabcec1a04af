#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "registration/partition.h"

namespace fathom {

/// Where a way leaves a convex part of space.
struct WayOut {
  std::size_t bound = 0;  ///< index of the plane
  double way_mm = 0.0;    ///< from the start; negative where the plane was passed before
};

/// The first of the planes that a way from `from_mm` along the unit vector `way` passes to their negative side. Empty
/// where it passes none, as it runs along them or away from them.
std::optional<WayOut> way_out(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& way,
                              std::span<const DividingPlane> bounds);

}  // namespace fathom
