#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "surface/sampled_layer.h"

namespace fathom {

/// Where the samples of a layer are and how the lattice is stretched there. Positions are affine in (m, j): `m` counts
/// half columns of the body-centred lattice, whole columns of the cubic one.
struct LayerGeometry {
  Eigen::Vector3d origin;
  Eigen::Vector3d per_m;
  Eigen::Vector3d per_j;
  /// The way to the next layer at (m, j): `next + m * next_per_m + j * next_per_j`.
  Eigen::Vector3d next;
  Eigen::Vector3d next_per_m;
  Eigen::Vector3d next_per_j;

  Eigen::Vector3d at(double m, double j) const { return origin + m * per_m + j * per_j; }

  /// From the field's change with each step of (m, j, k) to a vector along `outward`; singular where the lattice is
  /// flat.
  Eigen::Matrix3d outward_map(double m, double j) const {
    const Eigen::Vector3d step = next + m * next_per_m + j * next_per_j;
    const Eigen::Vector3d across = per_m.cross(per_j);
    Eigen::Matrix3d map;
    // The columns of the inverse transpose, times the determinant, whose sign is that of the layers' sense.
    map << per_j.cross(step), step.cross(per_m), across;
    return across.dot(step) < 0.0 ? map : Eigen::Matrix3d(-map);
  }

  /// The unit vector that points to where the field falls, from its change with each step of (m, j, k). Some unit
  /// vector where the field does not change or the lattice is flat.
  Eigen::Vector3d outward(const Eigen::Vector3d& change, double m, double j) const {
    const Eigen::Vector3d fall = outward_map(m, j) * change;
    const double length = fall.norm();
    if (length > 1e-300) return 1.0 / length * fall;
    const Eigen::Vector3d across = per_m.cross(per_j);
    return across.norm() > 1e-300 ? Eigen::Vector3d(across.normalized()) : Eigen::Vector3d::UnitZ();
  }
};

/// `below` and `above` are the layers around it; either may be null, not both. `columns_per_m` is 1/2 or 1.
inline LayerGeometry layer_geometry(const SampledLayer& layer, const SampledLayer* below, const SampledLayer* above,
                                    Lattice lattice) {
  const double columns_per_m = lattice == Lattice::kBodyCentred ? 0.5 : 1.0;
  const SampledLayer& from = below ? *below : layer;
  const SampledLayer& to = above ? *above : layer;
  const double share = below && above ? 0.5 : 1.0;
  return {layer.origin,
          columns_per_m * layer.column_step,
          layer.row_step,
          share * (to.origin - from.origin),
          share * columns_per_m * (to.column_step - from.column_step),
          share * (to.row_step - from.row_step)};
}

}  // namespace fathom
