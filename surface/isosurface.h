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

/// Which side of the threshold is inside; a value equal to it is inside on either side.
enum class Inside { kAbove, kBelow };

struct IsosurfaceOptions {
  double threshold = 0.0;
  Inside inside = Inside::kAbove;
  /// Closes the surface where the field is inside at the border: flat, through the border samples. Else it is open
  /// there.
  bool cap = false;
  /// The distance of layers, and of rows, of the lattice, in millimetres; it is stretched a little along each axis so
  /// that samples lie on the border. A volume's own smallest spacing where not given; a function needs it.
  std::optional<double> spacing_mm;
  Mesher mesher = Mesher::kRegularised;
  VertexPlacement placement = VertexPlacement::kAverage;
  /// The most memory that samples and mesh may take, besides the volume, in bytes.
  double memory_bytes = 4e9;
  /// Layers that are sampled and meshed at a time. The mesh does not depend on it.
  int batch_layers = 64;

  /// Throws Error when a number is not finite, the spacing or the memory not positive, or a batch without a layer.
  void check() const;
};

/// The surface in a volume where the values, linear between voxel centres, pass the threshold, with normals from the
/// field. `voxels` have any of OpenCV's pixel types but 16F and at least two samples along each axis. Memory besides
/// the mesh is that of a few layers, whatever the depth; the mesh is the same for any number of threads.
/// Throws Error when options or voxels are not as said, a voxel is not finite (and which), the voxel axes are flat, no
/// value or every value is inside (and within what limits they lie; all inside is an error only without `cap`), and
/// when the mesh would take more memory than allowed (and which spacing would not). Throws Cancelled.
Mesh isosurface(const Volume& volume, const IsosurfaceOptions& options, const Progress& progress = {});

/// A field at a point, in millimetres.
using PointField = std::function<double(const Eigen::Vector3d& point_mm)>;
/// A field at the points `start + i * step`, for every element i of `values`.
using RowField =
    std::function<void(const Eigen::Vector3d& start_mm, const Eigen::Vector3d& step_mm, std::span<double> values)>;

/// The same for a function over a box; it is called by several threads at once. Throws Error as above: when the
/// function is not finite (and where), the box is flat or there is no spacing.
Mesh isosurface(const PointField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress = {});
Mesh isosurface(const RowField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress = {});

/// Replaces the normals by a gradient's direction: away from where the field rises, or toward it where the inside lies
/// below the threshold. A vertex where the gradient is zero or not finite keeps its normal, if the mesh has normals,
/// and else gets the z axis.
void set_normals(Mesh& mesh, const std::function<Eigen::Vector3d(const Eigen::Vector3d& point_mm)>& gradient,
                 Inside inside = Inside::kAbove);

}  // namespace fathom
