#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "sim/solid.h"

namespace fathom {

namespace {

constexpr double kPi = std::numbers::pi;

/// Axial distance from the ball's centre to the circle in which a limb leaves the ball.
double exit_distance_mm(double ball_radius_mm, const Limb& limb) {
  return std::sqrt(ball_radius_mm * ball_radius_mm - limb.radius_mm * limb.radius_mm);
}

double limbed_ball_volume_mm3(double r, const std::vector<Limb>& limbs) {
  double volume = 4.0 / 3.0 * kPi * r * r * r;
  for (const Limb& limb : limbs) {
    const double z = exit_distance_mm(r, limb);
    const double cap = kPi / 3.0 * (r - z) * (r - z) * (2.0 * r + z);
    const double disc = kPi * limb.radius_mm * limb.radius_mm;
    volume += disc * (limb.length_mm - z) + 2.0 / 3.0 * disc * limb.radius_mm - cap;
  }
  return volume;
}

double limbed_ball_area_mm2(double r, const std::vector<Limb>& limbs) {
  double area = 4.0 * kPi * r * r;
  for (const Limb& limb : limbs) {
    const double z = exit_distance_mm(r, limb);
    area += 2.0 * kPi * limb.radius_mm * (limb.length_mm - z + limb.radius_mm) - 2.0 * kPi * r * (r - z);
  }
  return area;
}

double limbed_ball_reach_mm(const Eigen::Vector3d& centre, double r, const std::vector<Limb>& limbs) {
  double reach = centre.norm() + r;
  for (const Limb& limb : limbs) {
    reach = std::max(reach, (centre + limb.length_mm * limb.direction).norm() + limb.radius_mm);
  }
  return reach;
}

/// Outside the ball a limb is never seen from the ball's centre under a larger angle than where it leaves the ball.
[[maybe_unused]] bool limbs_keep_apart(double r, const std::vector<Limb>& limbs) {
  const auto exit_angle = [&](const Limb& limb) { return std::asin(limb.radius_mm / r); };
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    for (std::size_t k = i + 1; k < limbs.size(); ++k) {
      const double between = std::acos(std::clamp(limbs[i].direction.dot(limbs[k].direction), -1.0, 1.0));
      if (between < exit_angle(limbs[i]) + exit_angle(limbs[k])) return false;
    }
  }
  return true;
}

class LimbedBall final : public Solid {
 public:
  LimbedBall(const Eigen::Vector3d& centre, double radius, std::vector<Limb> limbs)
      : Solid(limbed_ball_volume_mm3(radius, limbs), limbed_ball_area_mm2(radius, limbs),
              limbed_ball_reach_mm(centre, radius, limbs)),
        centre_(centre),
        radius_(radius),
        limbs_(std::move(limbs)) {
    for ([[maybe_unused]] const Limb& limb : limbs_) {
      assert(limb.radius_mm < radius && limb.length_mm > exit_distance_mm(radius, limb));
    }
    assert(limbs_keep_apart(radius, limbs_));
  }

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    const Eigen::Vector3d offset = x - centre_;
    double nearest = offset.norm() - radius_;
    for (const Limb& limb : limbs_) {
      // A limb is all that lies within its radius of its axis.
      const double along = std::clamp(offset.dot(limb.direction), 0.0, limb.length_mm);
      nearest = std::min(nearest, (offset - along * limb.direction).norm() - limb.radius_mm);
    }
    return nearest;
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    Contact result{centre_ + radius_ * direction, false};
    for (const Limb& limb : limbs_) {
      const Eigen::Vector3d tip = centre_ + limb.length_mm * limb.direction + limb.radius_mm * direction;
      if (tip.dot(direction) > result.point_mm.dot(direction)) result.point_mm = tip;
    }
    return result;
  }

 private:
  Eigen::Vector3d centre_;
  double radius_;
  std::vector<Limb> limbs_;
};

}  // namespace

std::unique_ptr<Solid> make_limbed_ball(const Eigen::Vector3d& centre_mm, double radius_mm, std::vector<Limb> limbs) {
  return std::make_unique<LimbedBall>(centre_mm, radius_mm, std::move(limbs));
}

}  // namespace fathom
