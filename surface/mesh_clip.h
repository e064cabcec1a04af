#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "surface/mesh.h"

namespace fathom {

/// What becomes of a surface where a plane cuts it.
enum class Caps {
  kClosed,  ///< closed by flat triangles in the plane, so that a closed mesh stays one
  kOpen     ///< left open
};

/// A part of a mesh, with the faces that planes gave it.
struct ClippedMesh {
  static constexpr int kSurface = -1;

  Mesh mesh;
  /// For each triangle: the index of the plane that it closes, or kSurface where it is of the mesh that was cut.
  std::vector<int> plane_of;
};

/// The part of a mesh on the positive side of all `planes`, of unit normals, to which their normals point; it is convex
/// in space, the part of the mesh need not be. An edge that a plane cuts is cut once, so that its triangles share the
/// new vertex; faces in two planes share the edge along which these meet. Triangles are cut as split_polygon does. A
/// closed, manifold, oriented mesh stays one if closed by caps, also where vertices lie exactly on a plane (to 16 units
/// in the last place), which then belong to the positive side unless what touches the plane is all on the other. Where
/// nothing is left the result is empty. Sweep signs are kept; a cap gets that of what it closes. Normals at new
/// vertices are interpolated; caps share those of the surface.
/// Throws Error, for caps, when a plane cuts the mesh where it is open, branches or is not consistently oriented.
/// `mesh` must be valid (see require_valid).
ClippedMesh clip_mesh(const Mesh& mesh, std::span<const Eigen::Hyperplane<double, 3>> planes,
                      Caps caps = Caps::kClosed);

/// Both parts, which have the vertices and triangles of the cut in common.
struct SplitMesh {
  ClippedMesh positive;
  ClippedMesh negative;
};
SplitMesh split_mesh(const Mesh& mesh, const Eigen::Hyperplane<double, 3>& plane, Caps caps = Caps::kClosed);

/// The area of the caps in a plane, where the sweep sign is -1 counted negative.
double cap_area_mm2(const ClippedMesh& part, int plane);

}  // namespace fathom
