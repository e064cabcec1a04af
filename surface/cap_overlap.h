#pragma once

#include "surface/mesh_clip.h"

namespace fathom {

/// The area that the caps of two parts have in common, whatever their sweep signs: that of part `a` in its plane
/// `plane_a` and of part `b` in its `plane_b`, which are one plane with unit normal `normal`. Of two parts that
/// meet without a gap it is the area of either cap.
double cap_overlap_mm2(const ClippedMesh& a, int plane_a, const ClippedMesh& b, int plane_b,
                       const Eigen::Vector3d& normal);

}  // namespace fathom
