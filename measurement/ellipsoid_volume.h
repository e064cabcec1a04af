#pragma once

#include <optional>

#include <Eigen/Core>

#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// Volume by three diameters, as it is estimated by hand: length x width x height x 0.52.
struct EllipsoidVolume {
  Eigen::Vector3d diameters_mm = Eigen::Vector3d::Zero();  ///< descending
  double volume_ml = 0.0;
};

/// The diameters are the extents of all outline points along their principal axes. `recording` says which contours
/// `locator` places. Empty for fewer than two placed frames. 0.52 is pi / 6: exact for an ellipsoid outlined over its
/// whole length.
std::optional<EllipsoidVolume> ellipsoid_volume(const Structure& structure, const FrameLocator& locator, int recording);

}  // namespace fathom
