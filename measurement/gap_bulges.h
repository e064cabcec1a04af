#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace fathom {

/// What interpolation of second order adds to the linear one between two sections, at the nodes of a grid in (a, b) and
/// bilinear between them: it changes slowly, and finding it takes several correspondences a node.
///
/// Nodes lie at whole multiples of `pitch_mm`, so that they are where they are whatever is sampled. Beyond the grid,
/// and at nodes that the surface cannot come near, nothing is added.
struct GapBulges {
  double pitch_mm = 1.0;
  int first_column = 0;
  int first_row = 0;
  int columns = 0;
  int rows = 0;
  std::vector<float> values_mm;  ///< row by row; half-way between the planes a quarter of this is added
  std::vector<float> most_mm;    ///< the largest magnitude within two nodes of each
  float largest_mm = 0.0F;       ///< the largest magnitude of all

  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
  Eigen::Vector2d node_mm(int i, int j) const { return {(first_column + i) * pitch_mm, (first_row + j) * pitch_mm}; }

  float at_mm(const Eigen::Vector2d& ab_mm) const;

  /// No value within `pitch_mm` of the point along either axis has a larger magnitude.
  float most_near_mm(const Eigen::Vector2d& ab_mm) const;

  /// Fills in `most_mm` and `largest_mm` from the values.
  void find_most();
};

}  // namespace fathom
