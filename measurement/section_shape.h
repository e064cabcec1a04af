#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "measurement/column_grid.h"
#include "measurement/maximal_discs.h"
#include "measurement/outline_distance.h"
#include "measurement/section_raster.h"
#include "segmentation/contours.h"

namespace fathom {

/// What is known of a structure on a frame.
enum class SectionKind {
  kOutlined,
  kPoint,  ///< the frame only touches it: a cross-section of zero area
  kAbsent  ///< it was looked for and is not there
};

/// A cross-section as its distances: made once for a section, shared by the gaps on both sides of it, never changed.
///
/// Two fields are kept on the raster, positive inside and negative outside. The chamfer code (10 a cell across, 14
/// diagonally, +-5 beside the outline) gives maximal discs and is what correspondences are judged by. The distance, in
/// millimetres, is interpolated: it is Euclidean and, near the outline, exact, so that its zero level follows the drawn
/// line to second order in the cell size where that of the code follows it to half a cell.
///
/// All coordinates are (a, b) of SectionPlane in millimetres. Treece 2000, sections 3.2.2 and 3.2.3.
class SectionShape {
 public:
  /// Not there.
  SectionShape() = default;

  /// Touched at a point. Its one disc has the smallest radius, half a cell. Throws Error when a number is not finite or
  /// the cell not positive.
  SectionShape(const Eigen::Vector2d& point_mm, double cell_mm);

  /// Outlined by polygons that combine by even-odd and do not cross (`outline_fault`). `raster` must reach at least one
  /// cell beyond them, as that of `section_raster` does. Throws Error when there is no polygon, one has fewer than
  /// three points or a coordinate that is not finite, or the raster is too small or too large for them.
  SectionShape(std::vector<Polygon> outlines_mm, const SectionRaster& raster);

  SectionKind kind() const { return kind_; }
  double cell_mm() const { return raster_.cell_mm; }
  const SectionRaster& raster() const { return raster_; }
  const std::vector<Polygon>& outlines_mm() const { return outlines_mm_; }

  /// The signed distance at any point, on the raster or not, bilinear between the raster's points. Not for an absent
  /// section.
  float distance_mm(const Eigen::Vector2d& ab_mm) const { return distance_at_mm(in_cells(ab_mm)); }

  /// The same for loops that know where they are in cells, from the raster's origin.
  float distance_at_mm(const Eigen::Vector2f& at_cells) const;
  Eigen::Vector2f in_cells(const Eigen::Vector2d& ab_mm) const {
    return ((ab_mm - raster_.origin_mm) / raster_.cell_mm).cast<float>();
  }

  /// The chamfer code at any point, in the same way. At points in whole cells off the raster it is what a larger raster
  /// would hold, by equations (3.1) and (3.2); between them it is continuous. Not for an absent section.
  float code(const Eigen::Vector2d& ab_mm) const;

  /// Distances at all points of a grid, `grid.size()` of them: the layer of a lattice that lies on this section's
  /// plane.
  void sample(const ColumnGrid& grid, std::span<float> out) const;

  /// How far a point off the raster is outside of the outline at least; 0 on the raster.
  float least_outside_mm(const Eigen::Vector2d& ab_mm) const;

  const std::vector<Disc>& inside_discs() const { return inside_discs_; }
  const std::vector<Disc>& outside_discs() const { return outside_discs_; }

  /// The greatest distance on the raster; 0 for a point.
  float largest_inside_mm() const { return largest_inside_mm_; }

 private:
  // The points of the raster's rim with what lies nearest to them: all that is needed to find distances farther out.
  // In arrays, for fast loops; in blocks of kRimBlock, so that those that are too far can be passed over.
  struct Rim {
    std::vector<float> x, y;                  // cells
    std::vector<float> nearest_x, nearest_y;  // on the outline, cells
    std::vector<float> code;                  // above 0, though outside
  };
  struct RimBlock {
    Eigen::Vector2f low, high;                  // around its points
    Eigen::Vector2f nearest_low, nearest_high;  // around what is nearest to them
    float least_code;
  };
  static constexpr std::size_t kRimBlock = 16;

  void find_distances(NearestPoints nearest, const std::vector<std::uint8_t>& inside);
  float far_distance(const Eigen::Vector2f& at) const;
  float far_code(const Eigen::Vector2f& at) const;
  std::size_t rim_index(const Eigen::Vector2f& at) const;
  void add_rim_blocks();

  SectionKind kind_ = SectionKind::kAbsent;
  SectionRaster raster_;  // a point's has no points: its origin is the point
  std::vector<Polygon> outlines_mm_;
  std::vector<std::int16_t> codes_;
  std::vector<float> distances_mm_;
  Rim rim_;  // clockwise from the raster's origin, the last block filled up with copies
  std::vector<RimBlock> rim_blocks_;
  float rim_least_ = 0.0F;  // smallest distance on the rim, cells
  std::vector<Disc> inside_discs_;
  std::vector<Disc> outside_discs_;
  float largest_inside_mm_ = 0.0F;
};

}  // namespace fathom
