#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "sim/solid.h"

namespace fathom {

namespace {

constexpr double kPi = std::numbers::pi;

/// Axial distance from the ball's centre to the circle in which a limb leaves the ball.
double exit_distance_mm(double ball_radius_mm, const Limb& limb) {
  return std::sqrt(ball_radius_mm * ball_radius_mm - limb.radius_mm * limb.radius_mm);
}

/// The same of the circle in which a knob meets it.
double meeting_distance_mm(double r, const Knob& knob) {
  const double d = knob.distance_mm;
  return (d * d + r * r - knob.radius_mm * knob.radius_mm) / (2.0 * d);
}

double cap_volume_mm3(double radius_mm, double height_mm) {
  return kPi / 3.0 * height_mm * height_mm * (3.0 * radius_mm - height_mm);
}

double limbed_ball_volume_mm3(double r, const std::vector<Limb>& limbs, const std::vector<Knob>& knobs) {
  double volume = 4.0 / 3.0 * kPi * r * r * r;
  for (const Limb& limb : limbs) {
    const double z = exit_distance_mm(r, limb);
    const double cap = cap_volume_mm3(r, r - z);
    const double disc = kPi * limb.radius_mm * limb.radius_mm;
    volume += disc * (limb.length_mm - z) + 2.0 / 3.0 * disc * limb.radius_mm - cap;
  }
  for (const Knob& knob : knobs) {
    const double z = meeting_distance_mm(r, knob);
    volume += 4.0 / 3.0 * kPi * std::pow(knob.radius_mm, 3) - cap_volume_mm3(r, r - z) -
              cap_volume_mm3(knob.radius_mm, knob.radius_mm - (knob.distance_mm - z));
  }
  return volume;
}

double limbed_ball_area_mm2(double r, const std::vector<Limb>& limbs, const std::vector<Knob>& knobs) {
  double area = 4.0 * kPi * r * r;
  for (const Limb& limb : limbs) {
    const double z = exit_distance_mm(r, limb);
    area += 2.0 * kPi * limb.radius_mm * (limb.length_mm - z + limb.radius_mm) - 2.0 * kPi * r * (r - z);
  }
  for (const Knob& knob : knobs) {
    const double z = meeting_distance_mm(r, knob);
    area += 2.0 * kPi * knob.radius_mm * (knob.radius_mm + knob.distance_mm - z) - 2.0 * kPi * r * (r - z);
  }
  return area;
}

double limbed_ball_reach_mm(const Eigen::Vector3d& centre, double r, const std::vector<Limb>& limbs,
                            const std::vector<Knob>& knobs) {
  double reach = centre.norm() + r;
  for (const Limb& limb : limbs) {
    reach = std::max(reach, (centre + limb.length_mm * limb.direction).norm() + limb.radius_mm);
  }
  for (const Knob& knob : knobs) {
    reach = std::max(reach, (centre + knob.distance_mm * knob.direction).norm() + knob.radius_mm);
  }
  return reach;
}

/// Outside the ball a limb is never seen from the ball's centre under a larger angle than where it leaves the ball, a
/// knob not under a larger one than there or by its own radius.
[[maybe_unused]] bool limbs_keep_apart(double r, const std::vector<Limb>& limbs, const std::vector<Knob>& knobs) {
  std::vector<std::pair<Eigen::Vector3d, double>> cones;
  for (const Limb& limb : limbs) cones.emplace_back(limb.direction, std::asin(limb.radius_mm / r));
  for (const Knob& knob : knobs) {
    cones.emplace_back(knob.direction, std::max(std::acos(meeting_distance_mm(r, knob) / r),
                                                std::asin(knob.radius_mm / knob.distance_mm)));
  }
  for (std::size_t i = 0; i < cones.size(); ++i) {
    for (std::size_t k = i + 1; k < cones.size(); ++k) {
      const double between = std::acos(std::clamp(cones[i].first.dot(cones[k].first), -1.0, 1.0));
      if (between < cones[i].second + cones[k].second) return false;
    }
  }
  return true;
}

class LimbedBall final : public Solid {
 public:
  LimbedBall(const Eigen::Vector3d& centre, double radius, std::vector<Limb> limbs, std::vector<Knob> knobs)
      : Solid(limbed_ball_volume_mm3(radius, limbs, knobs), limbed_ball_area_mm2(radius, limbs, knobs),
              limbed_ball_reach_mm(centre, radius, limbs, knobs)),
        centre_(centre),
        radius_(radius),
        limbs_(std::move(limbs)),
        knobs_(std::move(knobs)) {
    for ([[maybe_unused]] const Limb& limb : limbs_) {
      assert(limb.radius_mm < radius && limb.length_mm > exit_distance_mm(radius, limb));
    }
    for ([[maybe_unused]] const Knob& knob : knobs_) {
      assert(knob.radius_mm < radius && knob.distance_mm < radius + knob.radius_mm);
    }
    assert(limbs_keep_apart(radius, limbs_, knobs_));
  }

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    const Eigen::Vector3d offset = x - centre_;
    double nearest = offset.norm() - radius_;
    for (const Limb& limb : limbs_) {
      // A limb is all that lies within its radius of its axis.
      const double along = std::clamp(offset.dot(limb.direction), 0.0, limb.length_mm);
      nearest = std::min(nearest, (offset - along * limb.direction).norm() - limb.radius_mm);
    }
    for (const Knob& knob : knobs_) {
      nearest = std::min(nearest, (offset - knob.distance_mm * knob.direction).norm() - knob.radius_mm);
    }
    return nearest;
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    Contact result{centre_ + radius_ * direction, false};
    for (const Limb& limb : limbs_) {
      const Eigen::Vector3d tip = centre_ + limb.length_mm * limb.direction + limb.radius_mm * direction;
      if (tip.dot(direction) > result.point_mm.dot(direction)) result.point_mm = tip;
    }
    for (const Knob& knob : knobs_) {
      const Eigen::Vector3d tip = centre_ + knob.distance_mm * knob.direction + knob.radius_mm * direction;
      if (tip.dot(direction) > result.point_mm.dot(direction)) result.point_mm = tip;
    }
    return result;
  }

 private:
  Eigen::Vector3d centre_;
  double radius_;
  std::vector<Limb> limbs_;
  std::vector<Knob> knobs_;
};

}  // namespace

std::unique_ptr<Solid> make_limbed_ball(const Eigen::Vector3d& centre_mm, double radius_mm, std::vector<Limb> limbs,
                                        std::vector<Knob> knobs) {
  return std::make_unique<LimbedBall>(centre_mm, radius_mm, std::move(limbs), std::move(knobs));
}

}  // namespace fathom
