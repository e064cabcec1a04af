#pragma once

#include <span>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// The area of all triangles, whatever their sweep sign. `mesh` must be valid (see require_valid), here and below.
double area_mm2(const Mesh& mesh);

/// The volume inside of a closed mesh, a triangle with sweep sign -1 counting negative; negative as a whole where the
/// mesh is turned inside out. Throws Error, which says what is wrong, when the mesh is empty, open, not manifold or not
/// consistently oriented (see MeshTopology). Independent of where the mesh lies to 1e-9 at 10 m from the origin.
double volume_mm3(const Mesh& mesh);

/// The centroid of that volume. Throws Error as volume_mm3 does, and when the volume is zero.
Eigen::Vector3d centroid_mm(const Mesh& mesh);

/// The same volume for a mesh that may be open where planes cut it: the volume inside of the surface and between the
/// planes. `plane_normals` are the normals of up to two planes, of any length; with two, the planes may be parallel.
/// Where a cut follows both planes they meet in its corners. Without planes the mesh must be closed.
/// Throws Error when the mesh is empty, not manifold or not consistently oriented; when there are more than two
/// normals, or one is zero or not finite; or when a part of the boundary does not lie in a plane normal to one of them
/// (in one plane normal to each), to within 1e-6 of the mesh's size.
/// Treece 2000, appendix B.2, equation (B.9) in a direction as in (B.10).
double projected_volume_mm3(const Mesh& mesh, std::span<const Eigen::Vector3d> plane_normals);

}  // namespace fathom
