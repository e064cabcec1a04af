#pragma once

#include <Eigen/Core>

#include "measurement/section_gap.h"

namespace fathom {

/// The space between two sections, filled by interpolation of second order: what SectionGap interpolates linearly, and
/// on top of it how the distances bend over three or four sections. Linear interpolation cuts off what bulges between
/// the planes (Treece 2000, figure 3.12, finds cubic interpolation worse, along lines that do not follow the structure;
/// here the neighbours are read where the guide leads).
///
/// Along the guided line through a point the bend is the second divided difference of the distances on this gap's two
/// planes and the next one, on either side; both sides are averaged where they agree in sign, to at most twice the
/// smaller, and count as straight where they do not, as at a branch. The surface still passes through the drawn
/// contours, and is the same from either end.
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

 private:
  const SectionGap& gap_;
  const SectionGap* before_;
  const SectionGap* after_;
  float most_mm_;
};

}  // namespace fathom
