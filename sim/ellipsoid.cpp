#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "sim/solid.h"

namespace fathom {

namespace {

constexpr double kPi = std::numbers::pi;

/// c2 t^2 + c3 t^3, continued by its tangents beyond +-reach: the solid ends there, and the slope stays bounded, which
/// the distance bound needs.
struct BoundedCubic {
  double c2 = 0.0;
  double c3 = 0.0;
  double reach = 0.0;

  double value(double t) const {
    const double inside = std::clamp(t, -reach, reach);
    return inside * inside * (c2 + c3 * inside) + slope(inside) * (t - inside);
  }
  double slope(double t) const {
    const double inside = std::clamp(t, -reach, reach);
    return inside * (2.0 * c2 + 3.0 * c3 * inside);
  }
  double largest_slope() const { return 2.0 * std::abs(c2) * reach + 3.0 * std::abs(c3) * reach * reach; }
};

struct BentShape {
  Eigen::Vector3d semi_axes;
  BoundedCubic along_x;
  BoundedCubic along_y;
  double shift;

  BentShape(const Eigen::Vector3d& axes, const Bend& bend)
      : semi_axes(axes),
        along_x{bend.x2, bend.x3, axes.x()},
        along_y{bend.y2, bend.y3, axes.y()},
        shift(bend.shift_mm) {}

  double displacement(double x, double y) const { return along_x.value(x) + along_y.value(y) + shift; }

  /// Of the surface, for a unit vector.
  Eigen::Vector3d point(const Eigen::Vector3d& unit) const {
    Eigen::Vector3d result = semi_axes.cwiseProduct(unit);
    result.z() += displacement(result.x(), result.y());
    return result;
  }
};

/// Nodes and weights of Gauss-Legendre quadrature on [-1, 1], by Newton's method on the Legendre polynomial.
template <int n>
std::array<std::pair<double, double>, n> gauss_legendre() {
  std::array<std::pair<double, double>, n> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5));
    double derivative = 1.0;
    for (int step = 0; step < 20; ++step) {
      double p0 = 1.0;
      double p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      derivative = n * (x * p1 - p0) / (x * x - 1.0);
      x -= p1 / derivative;
    }
    rule[static_cast<std::size_t>(i)] = {x, 2.0 / ((1.0 - x * x) * derivative * derivative)};
  }
  return rule;
}

/// Integral of the surface element over the unit sphere: Gauss-Legendre in z, trapezoid around, both converge
/// exponentially for so smooth a surface.
double surface_mm2(const BentShape& shape) {
  constexpr int kAround = 256;
  double area = 0.0;
  for (const auto& [z, weight] : gauss_legendre<96>()) {
    const double ring = std::sqrt(1.0 - z * z);
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * kPi * i / kAround;
      const Eigen::Vector3d unit(ring * std::cos(angle), ring * std::sin(angle), z);
      const Eigen::Vector3d east(-std::sin(angle), std::cos(angle), 0.0);
      const Eigen::Vector3d north = unit.cross(east);
      const auto moved = [&](const Eigen::Vector3d& tangent) -> Eigen::Vector3d {
        Eigen::Vector3d result = shape.semi_axes.cwiseProduct(tangent);
        result.z() += shape.along_x.slope(shape.semi_axes.x() * unit.x()) * result.x() +
                      shape.along_y.slope(shape.semi_axes.y() * unit.y()) * result.y();
        return result;
      };
      area += weight * (2.0 * kPi / kAround) * moved(east).cross(moved(north)).norm();
    }
  }
  return area;
}

/// From the origin to the farthest point, found on a mesh of directions; the margin is ten times the mesh's error.
double reach_mm(const BentShape& shape) {
  constexpr int kRings = 200;
  constexpr double kMargin = 1.001;
  double reach = 0.0;
  for (int i = 0; i <= kRings; ++i) {
    const double polar = kPi * i / kRings;
    for (int j = 0; j < 2 * kRings; ++j) {
      const double angle = kPi * j / kRings;
      const Eigen::Vector3d unit(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      reach = std::max(reach, shape.point(unit).norm());
    }
  }
  return reach * kMargin;
}

class BentEllipsoid final : public Solid {
 public:
  explicit BentEllipsoid(const BentShape& shape)
      : Solid(4.0 / 3.0 * kPi * shape.semi_axes.prod(), surface_mm2(shape), reach_mm(shape)),
        shape_(shape),
        inverse_axes_(shape.semi_axes.cwiseInverse()) {
    // Straightening stretches by at most the norm of a shear of slope g; the ellipsoid's own bound has slope one.
    const double g = std::hypot(shape.along_x.largest_slope(), shape.along_y.largest_slope());
    scale_ = shape.semi_axes.minCoeff() / ((g + std::sqrt(g * g + 4.0)) / 2.0);
  }

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    const Eigen::Vector3d straight(x.x(), x.y(), x.z() - shape_.displacement(x.x(), x.y()));
    return (straight.cwiseProduct(inverse_axes_).norm() - 1.0) * scale_;
  }

  Contact contact(const Eigen::Vector3d& direction) const override;

 private:
  BentShape shape_;
  Eigen::Vector3d inverse_axes_;
  double scale_;
};

Contact BentEllipsoid::contact(const Eigen::Vector3d& direction) const {
  const auto height = [&](const Eigen::Vector3d& unit) { return shape_.point(unit).dot(direction); };
  // A bent body can have several peaks: start from the best of many directions (a spiral over the sphere), then climb.
  constexpr int kStarts = 2000;
  const double golden_angle = kPi * (3.0 - std::sqrt(5.0));
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  for (int i = 0; i < kStarts; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kStarts;
    const double ring = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d unit(ring * std::cos(i * golden_angle), ring * std::sin(i * golden_angle), z);
    if (height(unit) > height(best)) best = unit;
  }
  // Near the peak the height falls with the square of the step, so the last step's error in height is far below 1e-9.
  constexpr double kLastStep = 1e-8;
  double best_height = height(best);
  for (double step = 0.05; step > kLastStep;) {
    const Eigen::Vector3d east = best.unitOrthogonal();
    const Eigen::Vector3d north = best.cross(east);
    bool climbed = false;
    for (int i = 0; i < 8; ++i) {
      const double angle = kPi * i / 4.0;
      const Eigen::Vector3d next = (best + step * (std::cos(angle) * east + std::sin(angle) * north)).normalized();
      if (height(next) > best_height) {
        best = next;
        best_height = height(next);
        climbed = true;
        break;
      }
    }
    if (!climbed) step /= 2.0;
  }
  return {shape_.point(best), false};
}

class Ellipsoid final : public Solid {
 public:
  explicit Ellipsoid(const Eigen::Vector3d& axes)
      : Solid(4.0 / 3.0 * kPi * axes.prod(), ellipsoid_surface_mm2(axes), axes.maxCoeff()),
        axes_(axes),
        inverse_axes_(axes.cwiseInverse()),
        smallest_(axes.minCoeff()) {}

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    return (x.cwiseProduct(inverse_axes_).norm() - 1.0) * smallest_;
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    const Eigen::Vector3d scaled = axes_.cwiseProduct(direction);
    return {axes_.cwiseProduct(scaled) / scaled.norm(), false};
  }

 private:
  static double ellipsoid_surface_mm2(const Eigen::Vector3d& axes) {
    const bool ball = axes.x() == axes.y() && axes.y() == axes.z();
    return ball ? 4.0 * kPi * axes.x() * axes.x() : surface_mm2(BentShape(axes, Bend{}));
  }

  Eigen::Vector3d axes_;
  Eigen::Vector3d inverse_axes_;
  double smallest_;
};

}  // namespace

std::unique_ptr<Solid> make_ellipsoid(const Eigen::Vector3d& semi_axes_mm) {
  return std::make_unique<Ellipsoid>(semi_axes_mm);
}

std::unique_ptr<Solid> make_bent_ellipsoid(const Eigen::Vector3d& semi_axes_mm, const Bend& bend) {
  return std::make_unique<BentEllipsoid>(BentShape(semi_axes_mm, bend));
}

}  // namespace fathom
