#pragma once

#include <vector>

#include <Eigen/Core>

#include "segmentation/contours.h"

namespace fathom {

/// The raster on which a section's distances are kept: square cells, `columns` by `rows` points, point (i, j) at
/// `origin_mm + cell_mm * (i, j)` in the coordinates (a, b) of SectionPlane.
struct SectionRaster {
  Eigen::Vector2d origin_mm = Eigen::Vector2d::Zero();
  double cell_mm = 1.0;
  int columns = 0;
  int rows = 0;
};

/// A maximal disc of a section. Treece 2000, section 3.2.3.
struct Disc {
  Eigen::Vector2d centre_mm = Eigen::Vector2d::Zero();
  double radius = 0.0;  ///< in chamfer units, 10 a cell: the field's value at the centre, negative for a disc outside
};

}  // namespace fathom
