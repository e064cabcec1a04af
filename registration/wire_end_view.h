#pragma once

#include <vector>

#include <Eigen/Core>

#include "registration/wire_identification.h"
#include "registration/wire_phantom.h"

namespace fathom {

inline constexpr double kLeastPatternSize_mm = 1.0;  ///< either way

/// Turns pixels so that wire 0 comes to lie on the left and the first pattern at the top.
Eigen::Matrix2d canonical_from_image(ImageOrientation orientation);

/// The phantom seen along its outer wires: x from wire 0 to wire 2, z from the first pattern to the last.
struct WireEndView {
  Eigen::Matrix3d phantom_from_view;  ///< columns: x, along the wires (front to back), z
  struct Pattern {
    Eigen::Vector2d left;      ///< wire 0, (x, z), mm
    Eigen::Vector2d right;     ///< wire 2
    double front_ratio = 0.0;  ///< of the middle wire's front, 0 at wire 0 and 1 at wire 2
    double back_ratio = 0.0;
    double front_mm = 0.0;  ///< where the middle wire's ends are along the wires
    double back_mm = 0.0;
  };
  std::vector<Pattern> patterns;
};

/// `phantom` has at least one pattern.
WireEndView wire_end_view(const WirePhantom& phantom);

}  // namespace fathom
