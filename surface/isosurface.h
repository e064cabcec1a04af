#pragma once

#include <functional>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include "core/progress.h"
#include "core/volume.h"
#include "surface/layer_mesher.h"
#include "surface/mesh.h"

namespace fathom {

struct IsosurfaceOptions {
  double value = 0.0;         ///< of the field on the surface; a sample that has just this value is inside
  bool inside_below = false;  ///< inside is at the value and below, else at the value and above
  /// Closes the surface along the border of the volume or box; else it is open where the inside reaches it.
  bool cap = false;
  /// Distance of layers and of rows of samples, mm. They begin and end on the border, and so are a little nearer to
  /// each other where the extent is no multiple of it. Where not given, the smallest distance of a volume's voxels; a
  /// function needs one.
  std::optional<double> spacing_mm;
  MesherOptions mesher;  ///< `cap_ends` and `cap_sides` do not matter; `cap` decides
  /// Layers that are sampled and meshed at a time; 0 for as many as suit the cache. The mesh does not depend on it.
  int batch_layers = 0;

  /// Throws Error when the value is not finite or the spacing is not above 0 and finite.
  void check() const;
};

/// The surface in a volume on which values, linear between the voxels' centres, are `options.value`; normals come from
/// the field. In one pass that keeps a few dozen layers of samples, whatever the depth; the same mesh for any number of
/// threads. Vertices lie where `reference_from_voxel` says; triangles face outward in left-handed frames too.
///
/// Throws Error when the voxels are not of one channel or fewer than two along an axis, their axes span no space, a
/// voxel that was met is not finite (and says which), the spacing is wider than the volume or so fine that samples or
/// mesh would not fit (and says which one would), or no value crosses `options.value` (and says what values there are).
/// A surface that is only a cap is none of these. Messages do not name a file; callers that know one put it in front.
/// Throws Cancelled.
Mesh isosurface(const Volume& volume, const IsosurfaceOptions& options, const Progress& progress = {});

/// A field at a place, mm. Called by several threads at once.
using PointField = std::function<double(const Eigen::Vector3d& place_mm)>;

/// A field at `start_mm + i * step_mm` for every element i of `values`. Called by several threads at once.
using RowField =
    std::function<void(const Eigen::Vector3d& start_mm, const Eigen::Vector3d& step_mm, std::span<double> values)>;

/// The same for a function in a box; it is not asked about places outside. Throws Error as above; also when the box is
/// empty or not finite or `options.spacing_mm` is not given. What the function throws is passed on.
Mesh isosurface(const PointField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress = {});
Mesh isosurface(const RowField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress = {});

/// Gives every vertex the unit vector along `outward` at its place, for instance the gradient of a field that rises
/// outward. Where that is zero or not finite the vertex keeps its normal, or gets that of its triangles if the mesh has
/// none. Called by several threads at once.
void set_normals(Mesh& mesh, const std::function<Eigen::Vector3d(const Eigen::Vector3d& place_mm)>& outward);

}  // namespace fathom
