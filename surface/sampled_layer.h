#pragma once

#include <vector>

#include <Eigen/Core>

namespace fathom {

/// How the samples of a stack of layers lie in each other.
enum class Lattice {
  /// Body-centred cubic, Treece 2000, section 3.4.2, figure 3.21 (c): sample i of row j in layer k lies at
  /// `origin + (i + ((j + k) % 2) / 2) * column_step + j * row_step`. In the regular lattice the column step is sqrt(2)
  /// times as long as the row step, and the layers are as far apart as the rows.
  kBodyCentred,
  /// Sample i of row j lies at `origin + i * column_step + j * row_step`: the corners of cubes.
  kCubic
};

/// A field on one plane of a lattice: at or above 0 inside of the surface, below 0 outside.
struct SampledLayer {
  int columns = 0;                                   ///< samples in each row; at least 2
  int rows = 0;                                      ///< at least 2
  std::vector<float> values;                         ///< rows times columns, row by row, finite
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< millimetres
  Eigen::Vector3d column_step = Eigen::Vector3d::UnitX();
  Eigen::Vector3d row_step = Eigen::Vector3d::UnitY();
  /// Of a body-centred lattice of at least 3 columns: the first sample of rows that are not shifted and the last one of
  /// those that are lie half a column further in, so that all rows begin and end in the same two planes.
  bool flat_sides = false;
};

}  // namespace fathom
