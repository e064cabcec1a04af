#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "measurement/column_grid.h"
#include "measurement/gap_bulges.h"
#include "measurement/section_gap.h"

namespace fathom {

/// The space between two sections, filled by interpolation of second order: what SectionGap interpolates linearly, and
/// on top of it how the distances bend over three or four sections. Linear interpolation cuts off what bulges between
/// the planes (Treece 2000, figure 3.12, finds cubic interpolation worse, along lines that do not follow the structure;
/// here the neighbours are read where the guide leads).
///
/// The guided line through a point goes on through the next gap, on either side, and on the planes that it meets the
/// distances are read. Their second divided difference tells how the distance bends along a line that itself bends,
/// where planes turn; less the bend of the line times the gradient of the distance it is that along the straight line.
/// Both sides are averaged where they agree in sign, to at most twice the smaller, and count as straight where they do
/// not, as at a branch. The surface still passes through the drawn contours, and is the same from either end.
class CurvedGap {
 public:
  /// `before` ends where `gap` starts and `after` starts where it ends; either may be missing (null), as may both. They
  /// must outlive this and have a guide other than kCentroids. Absent sections and those on planes that lie the other
  /// way tell nothing of the bend.
  CurvedGap(const SectionGap& gap, const SectionGap* before, const SectionGap* after);

  /// As SectionGap::value_mm.
  float value_mm(const Eigen::Vector2d& ab_mm, double u) const;

  /// What is added half-way between the planes is a quarter of this, millimetres.
  float bulge_mm(const Eigen::Vector2d& ab_mm) const;

  /// The same wherever the samples of a layer need it, for SectionGap::prepare. Grids of either parity of a lattice
  /// give the same.
  GapBulges bulges(const ColumnGrid& grid) const;

 private:
  struct Triple;
  std::vector<float> bulges_mm(const std::vector<Eigen::Vector2d>& ab_mm) const;
  float most_mm(const Eigen::Vector2d& ab_mm) const;

  const SectionGap& gap_;
  const SectionGap* before_;
  const SectionGap* after_;
  float deepest_mm_;
};

}  // namespace fathom
