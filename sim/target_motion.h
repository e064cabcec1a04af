#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/random.h"
#include "sim/target_echo.h"

namespace fathom {

/// How far a hand moves a probe about its place over a target; amplitudes to both sides.
struct Sway {
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< twist about the vertical, tilt about image x, rock in plane
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();  ///< of the target's place: image x, across the image, image y
};

/// The way of a probe in a water bath, whose coordinates have z up. The probe looks down.
class TargetMotion {
 public:
  /// At rest the image's point `anchor_mm` (image axes, mm) lies at the bath's origin; with `anchor_sways` the hand's
  /// shifts move the anchor within the image and the image turns about it, so that a small target stays in view; else
  /// they move the image. `floor_like` moves up and down as for finding a latency: again and again, never quite alike.
  TargetMotion(const Sway& sway, const Eigen::Vector2d& anchor_mm, bool anchor_sways, bool floor_like, Random random);

  /// Rigid: image axes (mm) to the bath, at a time in seconds, which may be negative.
  Eigen::Isometry3d bath_from_image(double time_s) const;

 private:
  double up_and_down(double time_s) const;

  Sway sway_;
  Eigen::Vector2d anchor_mm_;
  bool anchor_sways_;
  bool floor_like_;
  std::array<double, 8> phase_{};
};

}  // namespace fathom
