#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Core>

#include "core/volume.h"
#include "surface/isosurface.h"
#include "surface/lattice_layout.h"

namespace fathom {

/// A row of a lattice in a box: its samples are half a column further where `shifted`. A body-centred lattice begins
/// half a column before the box; samples that would lie outside are those of the box's faces.
struct LatticeRow {
  int row = 0;
  int layer = 0;
  bool shifted = false;
};

/// A field as rows of samples: at or above 0 inside. Called by several threads at once.
class FieldRows {
 public:
  virtual ~FieldRows() = default;

  /// Not finite where the field is not.
  virtual void sample(const LatticeRow& row, std::span<float> values) const = 0;
  /// What is not finite at a sample, and where, for a message.
  virtual std::string fault_at(const LatticeRow& row, int column) const = 0;
  /// The smallest and largest value of the field, where it was sampled.
  virtual std::pair<double, double> value_range() const = 0;
};

/// Values of a function in a box.
std::unique_ptr<FieldRows> function_rows(const RowField& field, const Eigen::Vector3d& low_mm,
                                         const LatticeLayout& layout, const IsosurfaceOptions& options);

/// How far the columns of a row begin from the box, in column steps.
double first_column(Lattice lattice, bool shifted);

/// Distances between a volume's voxels along its axes, mm.
/// Throws Error when the volume has not one channel of a type that can be read, fewer than two voxels along an axis, or
/// axes that span no space.
Eigen::Vector3d voxel_spacing_mm(const Volume& volume);

/// A volume's values, trilinear between voxel centres. A row of samples that lies in a row of voxels, as all do where
/// the lattice has the volume's spacing, is read without looking at other rows.
std::unique_ptr<FieldRows> volume_rows(const Volume& volume, const LatticeLayout& layout,
                                       const IsosurfaceOptions& options);

/// A sample of a field that is inside by `inside_by`, with the sign kept where a float has no such number.
float to_sample(double inside_by);

}  // namespace fathom
