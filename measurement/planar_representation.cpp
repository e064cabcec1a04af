#include "measurement/planar_representation.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "measurement/sweep_path.h"

namespace fathom {

namespace {

// Radians. Symmetric scans make both candidates equally good up to rounding, and rounding must not choose.
constexpr double kTie = 1e-3;

// A direction in the plane, as an angle, that follows another by a turn whose size is known in space.
class TurningDirection {
 public:
  // Sets out without a turn.
  void start(double angle) { angle_ = angle; }

  bool started() const { return angle_.has_value(); }
  double angle() const { return *angle_; }

  // Goes to `plus` or `minus`, whichever turns more nearly by `turn_in_space` (in [0, pi]). Says whether that left
  // the choice open.
  bool follow(double plus, double minus, double turn_in_space) {
    const double turn_plus = wrapped(plus - *angle_);
    const double turn_minus = wrapped(minus - *angle_);
    const double misfit_plus = std::abs(std::abs(turn_plus) - turn_in_space);
    const double misfit_minus = std::abs(std::abs(turn_minus) - turn_in_space);
    const bool tie = std::abs(misfit_plus - misfit_minus) < kTie;
    const bool same_place = std::abs(wrapped(plus - minus)) < 1e-9;
    const bool take_plus = tie ? (sense_ >= 0.0) == (turn_plus >= turn_minus) : misfit_plus < misfit_minus;
    const double turn = take_plus ? turn_plus : turn_minus;
    angle_ = take_plus ? plus : minus;
    // The sign of no turn, and of a turn right about, is rounding.
    if (std::abs(turn) > kTie && std::abs(turn) < std::numbers::pi - kTie) sense_ = turn;
    return tie && !same_place;
  }

 private:
  static double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

  std::optional<double> angle_;
  double sense_ = 0.0;
};

// In [0, pi]; unlike the arc cosine it is precise for small angles.
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

PlanarRepresentation planar_representation(std::span<const CrossSection> sections) {
  assert(sections.size() >= 2);
  const double no_step = kNoStep * path_length_mm(sections);
  PlanarRepresentation plane;
  plane.normals.reserve(sections.size());
  plane.centres.reserve(sections.size());

  TurningDirection line;  // the direction of the lines' normals
  TurningDirection way;   // the direction from centre to centre
  line.start(0.0);
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector3d normal_before = facing(sections.front());
  Eigen::Vector3d step_before = Eigen::Vector3d::Zero();
  plane.normals.push_back(sections.front().vector_area_mm2.norm() * direction(line.angle()));
  plane.centres.push_back(centre);

  for (std::size_t i = 1; i < sections.size(); ++i) {
    const Eigen::Vector3d normal = facing(sections[i]);
    const Eigen::Vector3d step = sections[i].centroid_mm - sections[i - 1].centroid_mm;
    const double turn_of_normal = angle_between(normal_before, normal);
    if (step.norm() <= no_step) {
      // A step that goes nowhere has no direction, and adds nothing: only the line turns.
      const double from = line.angle();
      plane.ambiguous |= line.follow(from + turn_of_normal, from - turn_of_normal, turn_of_normal);
    } else {
      const double alpha = angle_between(normal_before, step);
      const double beta = angle_between(normal, step);
      if (way.started()) {
        plane.ambiguous |= way.follow(line.angle() + alpha, line.angle() - alpha, angle_between(step_before, step));
      } else {
        way.start(line.angle() + alpha);  // the other side is the mirror image
      }
      plane.ambiguous |= line.follow(way.angle() + beta, way.angle() - beta, turn_of_normal);
      centre += step.norm() * direction(way.angle());
      step_before = step;
    }
    normal_before = normal;
    plane.normals.push_back(sections[i].vector_area_mm2.norm() * direction(line.angle()));
    plane.centres.push_back(centre);
  }
  return plane;
}

}  // namespace fathom
