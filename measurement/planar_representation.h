#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "measurement/cross_section.h"

namespace fathom {

/// A sweep drawn in the plane: a line for each cross-section, as long as its area is large, and the way from centre
/// to centre, as long as from centroid to centroid. Linear planimetry of both is the same.
/// Treece 2000, section 2.2.3, figures 2.2 and 2.3.
struct PlanarRepresentation {
  std::vector<Eigen::Vector2d> normals;  ///< of the lines, with the lines' lengths: the areas in mm2
  std::vector<Eigen::Vector2d> centres;  ///< of the lines, in mm
  bool ambiguous = false;                ///< the angles in space left the side of at least one turn open
};

/// `sections` are in scan order, at least two, with finite values.
///
/// The angles between lines and way are known up to sign; each sign is the one whose turn, between successive pieces
/// of the way or between successive lines, comes nearest to the angle in space. Where both come equally near, the
/// turn keeps the sense of the one before it; only then can the result depend on the end that is read first.
PlanarRepresentation planar_representation(std::span<const CrossSection> sections);

}  // namespace fathom
