#pragma once

#include <Eigen/Core>

#include "surface/sampled_layer.h"

namespace fathom {

/// How many samples a lattice has in a box and how far apart they are along its edges.
struct LatticeLayout {
  int columns = 0;
  int rows = 0;
  int layers = 0;
  Eigen::Vector3d step_mm = Eigen::Vector3d::Zero();  ///< between columns, rows and layers
};

/// A lattice in a box whose edges are `extent_mm` long. Rows and layers, nearly `spacing_mm` apart and not more, begin
/// and end on the box's faces; so do the columns of a cubic lattice. Those of a body-centred lattice begin half a
/// column before the box and end half a column behind it, alternately; such samples are drawn in to the faces, so that
/// the rows, too, begin and end on them (SampledLayer::flat_sides). Throws Error when the spacing is wider than the
/// box, or so fine that the samples or a surface of the box's size would not fit into memory or a reasonable time: with
/// what it would take and a spacing that fits.
LatticeLayout lattice_layout(const Eigen::Vector3d& extent_mm, double spacing_mm, Lattice lattice);

}  // namespace fathom
