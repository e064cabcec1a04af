#include "sim/solid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace fathom {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kParallel = 1e-9;  // rad: a plane turned by less against a face lies in it

class Cone final : public Solid {
 public:
  Cone(double radius_mm, double height_mm)
      : Solid(kPi * radius_mm * radius_mm * height_mm / 3.0,
              kPi * radius_mm * (radius_mm + std::hypot(radius_mm, height_mm)), std::hypot(radius_mm, height_mm / 2.0)),
        radius_mm_(radius_mm),
        half_height_mm_(height_mm / 2.0),
        sine_(radius_mm / std::hypot(radius_mm, height_mm)),
        cosine_(height_mm / std::hypot(radius_mm, height_mm)) {}

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    const double below_base = -half_height_mm_ - x.z();
    const double beside = std::hypot(x.x(), x.y()) * cosine_ - (half_height_mm_ - x.z()) * sine_;
    return std::max(below_base, beside);
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    const double across = std::hypot(direction.x(), direction.y());
    if (direction.z() < 0.0 && across < kParallel) return {{0.0, 0.0, -half_height_mm_}, true};
    const double at_tip = half_height_mm_ * direction.z();
    const double at_rim = radius_mm_ * across - half_height_mm_ * direction.z();
    if (at_tip >= at_rim) return {{0.0, 0.0, half_height_mm_}, false};
    return {{radius_mm_ * direction.x() / across, radius_mm_ * direction.y() / across, -half_height_mm_}, false};
  }

 private:
  double radius_mm_;
  double half_height_mm_;
  double sine_;  // of the half angle at the tip
  double cosine_;
};

class Box final : public Solid {
 public:
  explicit Box(const Eigen::Vector3d& half)
      : Solid(8.0 * half.prod(), 8.0 * (half.x() * half.y() + half.y() * half.z() + half.z() * half.x()), half.norm()),
        half_(half) {}

  double distance_bound_mm(const Eigen::Vector3d& x) const override { return (x.cwiseAbs() - half_).maxCoeff(); }

  Contact contact(const Eigen::Vector3d& direction) const override {
    Contact result;
    int free_axes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction[axis]) < kParallel) {
        ++free_axes;  // the whole edge or face touches: its middle stands for it
      } else {
        result.point_mm[axis] = std::copysign(half_[axis], direction[axis]);
      }
    }
    result.on_face = free_axes == 2;
    return result;
  }

 private:
  Eigen::Vector3d half_;
};

/// Axial distance from the ball's centre to the circle in which a spike leaves the ball.
double exit_distance_mm(double ball_radius_mm, const Spike& spike) {
  // z^2 + (l - z)^2 t^2 = r^2, the root nearer to the tip.
  const double t2 = std::pow(std::tan(spike.half_angle_rad), 2);
  const double l = spike.length_mm;
  const double a = 1.0 + t2;
  const double b = -l * t2;
  const double c = l * l * t2 - ball_radius_mm * ball_radius_mm;
  return (-b + std::sqrt(b * b - a * c)) / a;
}

double spiked_ball_volume_mm3(double r, const std::vector<Spike>& spikes) {
  double volume = 4.0 / 3.0 * kPi * r * r * r;
  for (const Spike& spike : spikes) {
    const double z = exit_distance_mm(r, spike);
    const double tangent = std::tan(spike.half_angle_rad);
    const double cone = kPi / 3.0 * std::pow(spike.length_mm - z, 3) * tangent * tangent;
    const double cap = kPi / 3.0 * (r - z) * (r - z) * (2.0 * r + z);
    volume += cone - cap;
  }
  return volume;
}

double spiked_ball_area_mm2(double r, const std::vector<Spike>& spikes) {
  double area = 4.0 * kPi * r * r;
  for (const Spike& spike : spikes) {
    const double z = exit_distance_mm(r, spike);
    const double generator = (spike.length_mm - z) / std::cos(spike.half_angle_rad);
    area += kPi * generator * generator * std::sin(spike.half_angle_rad) - 2.0 * kPi * r * (r - z);
  }
  return area;
}

double spiked_ball_reach_mm(const Eigen::Vector3d& centre, double r, const std::vector<Spike>& spikes) {
  double reach = centre.norm() + r;
  for (const Spike& spike : spikes) reach = std::max(reach, (centre + spike.length_mm * spike.direction).norm());
  return reach;
}

/// Whether no two spikes overlap outside the ball, where each stays within the cone from the ball's centre through the
/// circle in which it leaves the ball.
[[maybe_unused]] bool spikes_keep_apart(double r, const std::vector<Spike>& spikes) {
  const auto exit_angle = [&](const Spike& spike) { return std::acos(exit_distance_mm(r, spike) / r); };
  for (std::size_t i = 0; i < spikes.size(); ++i) {
    for (std::size_t k = i + 1; k < spikes.size(); ++k) {
      const double between = std::acos(std::clamp(spikes[i].direction.dot(spikes[k].direction), -1.0, 1.0));
      if (between < exit_angle(spikes[i]) + exit_angle(spikes[k])) return false;
    }
  }
  return true;
}

class SpikedBall final : public Solid {
 public:
  SpikedBall(const Eigen::Vector3d& centre, double radius, std::vector<Spike> spikes)
      : Solid(spiked_ball_volume_mm3(radius, spikes), spiked_ball_area_mm2(radius, spikes),
              spiked_ball_reach_mm(centre, radius, spikes)),
        centre_(centre),
        radius_(radius),
        spikes_(std::move(spikes)) {
    for (const Spike& spike : spikes_) {
      assert(spike.length_mm > radius && spike.length_mm * std::tan(spike.half_angle_rad) < radius);
      cosines_.push_back(std::cos(spike.half_angle_rad));
      sines_.push_back(std::sin(spike.half_angle_rad));
    }
    assert(spikes_keep_apart(radius, spikes_));
  }

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    const Eigen::Vector3d offset = x - centre_;
    const double squared = offset.squaredNorm();
    double nearest = std::sqrt(squared) - radius_;
    for (std::size_t i = 0; i < spikes_.size(); ++i) {
      const double along = offset.dot(spikes_[i].direction);
      const double across = std::sqrt(std::max(0.0, squared - along * along));
      // The cone starts at the ball's centre, where its base disc lies inside the ball.
      const double beside = across * cosines_[i] - (spikes_[i].length_mm - along) * sines_[i];
      nearest = std::min(nearest, std::max(-along, beside));
    }
    return nearest;
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    Contact result{centre_ + radius_ * direction, false};
    double farthest = result.point_mm.dot(direction);
    for (const Spike& spike : spikes_) {
      const Eigen::Vector3d tip = centre_ + spike.length_mm * spike.direction;
      if (tip.dot(direction) > farthest) {
        farthest = tip.dot(direction);
        result.point_mm = tip;
      }
    }
    return result;
  }

 private:
  Eigen::Vector3d centre_;
  double radius_;
  std::vector<Spike> spikes_;
  std::vector<double> cosines_;
  std::vector<double> sines_;
};

}  // namespace

std::unique_ptr<Solid> make_cone(double radius_mm, double height_mm) {
  return std::make_unique<Cone>(radius_mm, height_mm);
}

std::unique_ptr<Solid> make_box(const Eigen::Vector3d& half_sizes_mm) { return std::make_unique<Box>(half_sizes_mm); }

std::unique_ptr<Solid> make_spiked_ball(const Eigen::Vector3d& centre_mm, double radius_mm, std::vector<Spike> spikes) {
  return std::make_unique<SpikedBall>(centre_mm, radius_mm, std::move(spikes));
}

}  // namespace fathom
