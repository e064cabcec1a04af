#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "surface/sampled_layer.h"

namespace fathom {

/// One layer of a lattice in the coordinates (a, b) of SectionPlane, millimetres. Through each of its samples runs a
/// column of the lattice, which meets all other layers of the same parity between two sections at the same (a, b).
struct ColumnGrid {
  Eigen::Vector2d start_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d column_step_mm = Eigen::Vector2d::UnitX();
  Eigen::Vector2d row_step_mm = Eigen::Vector2d::UnitY();
  int columns = 0;  ///< samples in each row
  int rows = 0;
  Lattice lattice = Lattice::kBodyCentred;
  int parity = 0;  ///< of the layer's number, 0 or 1; without meaning for Lattice::kCubic

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  /// Where row j begins.
  Eigen::Vector2d row_start_mm(int j) const {
    const bool shifted = lattice == Lattice::kBodyCentred && (j + parity) % 2 != 0;
    return start_mm + j * row_step_mm + (shifted ? 0.5 : 0.0) * column_step_mm;
  }

  /// The farthest that an edge of the lattice leads in the plane.
  double longest_edge_mm() const {
    const Eigen::Vector2d half = 0.5 * column_step_mm;
    double square = std::max(column_step_mm.squaredNorm(), row_step_mm.squaredNorm());
    square = std::max({square, (half + row_step_mm).squaredNorm(), (half - row_step_mm).squaredNorm()});
    return std::sqrt(square);
  }
};

}  // namespace fathom
