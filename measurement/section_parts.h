#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "measurement/section_shape.h"

namespace fathom {

/// One part of a section, an outline with the holes in it, or its point.
struct SectionPart {
  std::shared_ptr<const SectionShape> shape;
  Eigen::Vector2d centroid_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d size_mm = Eigen::Vector2d::Ones();  ///< of its bounding rectangle
};

/// Two parts that centroid-guided interpolation joins. One of them is empty where a part has no partner because the
/// other section is absent.
struct PartPair {
  SectionPart first;
  SectionPart second;
};

/// The parts of a section; none where it is absent.
std::vector<SectionPart> section_parts(const std::shared_ptr<const SectionShape>& shape);

/// Whether two parts, of different sections, overlap.
bool parts_meet(const SectionPart& a, const SectionPart& b);

/// Which parts belong together: those that overlap, and for a part that overlaps none the one with the nearest
/// centroid. A part may be in several pairs. Treece 2000, section 3.5 (there by hand).
std::vector<PartPair> matching_parts(const std::shared_ptr<const SectionShape>& first,
                                     const std::shared_ptr<const SectionShape>& second);

}  // namespace fathom
