#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "measurement/column_grid.h"
#include "measurement/disc_guide.h"
#include "measurement/gap_bulges.h"
#include "measurement/section_parts.h"
#include "measurement/section_plane.h"
#include "measurement/section_shape.h"

namespace fathom {

/// Along which lines the space between two sections is interpolated. Treece 2000, section 3.5.
enum class Guide {
  kDiscs,      ///< maximal discs lead to corresponding parts: section 3.2
  kCentroids,  ///< from the centroid of a part to that of its partner, scaled to its size
  kShape       ///< straight across: shape-based interpolation
};

/// A section in space.
struct PlacedSection {
  SectionPlane plane;
  std::shared_ptr<const SectionShape> shape;
};

/// What all layers of one parity between two sections have in common: made by SectionGap::prepare.
class GapColumns {
 public:
  const ColumnGrid& grid() const { return grid_; }

  /// Columns with samples that are found along their own lines; the sign of the others is the same all along.
  std::size_t guided() const { return guided_.size(); }

 private:
  friend class SectionGap;

  // A column whose samples are found along their own lines.
  struct Guided {
    std::size_t index = 0;
    Eigen::Vector2f first_cells = Eigen::Vector2f::Zero();  // where it meets the sections, in their cells
    Eigen::Vector2f second_cells = Eigen::Vector2f::Zero();
    Eigen::Vector2f c_first_cells = Eigen::Vector2f::Zero();  // its correspondence vector, in cells of each section
    Eigen::Vector2f c_second_cells = Eigen::Vector2f::Zero();
    float ahead_mm = 0.0F;    // of the second plane
    float rise_mm = 0.0F;     // more of it at the end of the vector
    float certain_mm = 0.0F;  // beyond this the sign of the distance interpolated straight across is certain
    float bulge_mm = 0.0F;    // what interpolation of second order adds, as in GapBulges
  };

  ColumnGrid grid_;
  // Both sections' distances where a column meets them, or bounds of them far outside.
  std::vector<float> first_mm_;
  std::vector<float> second_mm_;
  std::vector<Guided> guided_;
};

/// The space between two successive sections, filled by interpolation of their distances.
///
/// A point of it is given by (a, b) and a fraction u: it lies at u on the straight line from (a, b) on the first plane,
/// u = 0, to the same (a, b) on the second, u = 1. The planes may be at any angle below 180 degrees, and may cross. The
/// interpolation line through the point leads by the correspondence vector from one plane to the other and meets them
/// on either side of the point (figure 3.15); both distances are weighted by the lengths of its parts (3.11). Points on
/// the planes have the distances of their sections, whatever the guide.
///
/// Where one section is absent the structure tapers off: that plane counts as outside everywhere, by as much as the
/// other section's deepest point is inside, so that the structure ends half-way. Where both are, all is outside.
///
/// Reading a gap from its other end gives the same field. Treece 2000, section 3.2.6.
class SectionGap {
 public:
  SectionGap(PlacedSection first, PlacedSection second, Guide guide);

  /// The interpolated distance in millimetres, positive inside, at u in [0, 1].
  float value_mm(const Eigen::Vector2d& ab_mm, double u) const;

  /// Prepares a layer's columns for `sample`: finds the correspondence of every column near the surface. `layer_step`
  /// is how far apart in u neighbouring layers are, at most. With `bulges` (of CurvedGap) the interpolation is of
  /// second order; not for kCentroids.
  GapColumns prepare(const ColumnGrid& grid, double layer_step = 1.0, const GapBulges* bulges = nullptr) const;

  /// The samples of the layer at u, `columns.grid().size()` of them. They equal
  /// `value_mm` wherever a sample within two lattice edges, along the layer or to the next two layers, has another
  /// sign; the others have the right sign and are farther from zero than two edges are long. So a surface extracted
  /// from them is the same. At u = 0 and u = 1 this is for this gap only: what
  /// lies on a plane must also suit the gap beyond it, so take it from
  /// SectionShape::sample.
  void sample(const GapColumns& columns, double u, std::span<float> out) const;

  /// Equation (3.12): 1 where the second plane lies ahead of the first along the average normal, -1 where it lies
  /// behind, in a region that is swept again and counts negative, 0 on the line where they cross.
  int sweep_sign(const Eigen::Vector2d& ab_mm) const;

  /// Where the point of the first section at (a, b) goes on the second, relative to (a, b). Zero unless the guide is
  /// kDiscs.
  Eigen::Vector2d correspondence_mm(const Eigen::Vector2d& ab_mm) const;

  /// The same for many points, faster.
  std::vector<Eigen::Vector2d> correspondences_mm(const std::vector<Eigen::Vector2d>& ab_mm) const;

  /// By what share of a bulge (GapBulges) interpolation of second order differs from `value_mm`: w (1 - w), w the
  /// weight of the second section. Not for kCentroids.
  float bulge_share(const Eigen::Vector2d& ab_mm, double u) const;

  /// Where the distances to both sections are beyond this on the same side, so is all between them: without sign,
  /// for the samples of a grid and their neighbours.
  double certain_mm(const ColumnGrid& grid) const;

  /// False where the distances to both sections are beyond `certain_mm` on the same side. Sections that are absent or
  /// touched at a point are near everywhere.
  bool may_cross(const Eigen::Vector2d& ab_mm, double certain_mm) const;

  /// How far the second plane lies ahead of the first along the average normal.
  double ahead_mm(const Eigen::Vector2d& ab_mm) const { return ahead_at_origin_mm_ + ahead_slope_.dot(ab_mm); }

  const PlacedSection& first() const { return first_; }
  const PlacedSection& second() const { return second_; }
  Guide guide() const { return guide_; }

 private:
  struct Line;
  static Line line(float ahead_mm, float rise_mm, float u);
  float along_mm(const Eigen::Vector2d& ab_mm, const Eigen::Vector2d& c_mm, double u) const;
  float distance_mm(const PlacedSection& section, const Eigen::Vector2d& ab_mm) const;
  double longest_mm() const;
  float least_outside_mm(const PlacedSection& section, const Eigen::Vector2d& ab_mm) const;
  float certain_mm(const ColumnGrid& grid, double layer_step, const Eigen::Vector2d& ab_mm, float difference_mm) const;
  void find_correspondences(GapColumns& columns, const std::vector<Eigen::Vector2d>& ab_mm) const;
  float part_value_mm(const PartPair& pair, const Eigen::Vector2d& ab_mm, double u) const;

  PlacedSection first_;
  PlacedSection second_;
  Guide guide_;
  float absent_mm_ = 0.0F;  // the distance that stands for an absent section
  // How far the second plane lies ahead of the first is linear in (a, b).
  double ahead_at_origin_mm_ = 0.0;
  Eigen::Vector2d ahead_slope_ = Eigen::Vector2d::Zero();
  std::optional<DiscGuide> discs_;
  std::vector<PartPair> pairs_;
};

}  // namespace fathom
