#pragma once

#include <Eigen/Core>

#include "surface/star.h"

namespace fathom {

/// The weight of the cut of `edge` in its cluster, Treece 2000, equations (3.13) to (3.16): 1 / tan(beta / 2) in the
/// plane where the surface bends most, and never 0. `normal` is the surface's, in the regular lattice.
double bend_weight(const Star& star, int edge, const Eigen::Vector3d& normal);

}  // namespace fathom
