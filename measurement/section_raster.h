#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
};

/// Most points of a raster along either axis: 16-bit chamfer codes reach no farther than 2^15 / 14 of them.
inline constexpr int kMostRasterPoints = 2300;

/// Cells around an outline by default: as far as a surface of lattice spacing two cells needs exact distances.
inline constexpr int kRasterMargin = 8;

/// The raster around outlines, which are in millimetres: their bounding rectangle and `margin` cells on every side, its
/// points at whole multiples of the cell. Throws Error when there are no outlines, one has fewer than three points or a
/// coordinate that is not finite or beyond 10 m, the cell is not positive, or the raster would have more than
/// kMostRasterPoints along an axis: the message says which cell fits.
SectionRaster section_raster(std::span<const Polygon> outlines_mm, double cell_mm, int margin = kRasterMargin);

/// Which of the raster's points lie inside outlines combined by even-odd: 1 inside, 0 outside. `outlines` are in cells
/// from the raster's origin. Treece 2000, appendix C.1.
std::vector<std::uint8_t> inside_outlines(std::span<const Polygon> outlines, const SectionRaster& raster);

}  // namespace fathom
