#pragma once

namespace fathom {

/// Along which lines the space between two sections is interpolated. Treece 2000, section 3.5.
enum class Guide {
  kDiscs,      ///< maximal discs lead to corresponding parts: section 3.2
  kCentroids,  ///< from the centroid of a contour to that of its partner, scaled to its size
  kShape       ///< straight across: shape-based interpolation
};

}  // namespace fathom
