#include "sim/solid_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fathom {

namespace {

constexpr double kInset = 0.01;        // of the solid's radius
constexpr double kResolution = 0.001;  // of the solid's radius, to which a part's edge is found

/// Looks for the highest point of a part from large cubes to small ones, the upper ones first. Cubes that lie outside
/// by the distance bound, or below what was found already, are left out.
class Climb {
 public:
  template <typename Bound>
  Climb(const Bound& bound_mm, const Eigen::Matrix3d& axes, double radius_mm, double highest_mm)
      : axes_(axes), smallest_mm_(radius_mm * kResolution), highest_mm_(highest_mm) {
    search(bound_mm, Eigen::Vector3d::Zero(), radius_mm);
  }

  bool found() const { return std::isfinite(best_mm_); }
  Eigen::Vector3d point_mm() const { return axes_ * best_; }
  double height_mm() const { return best_mm_; }
  double resolution_mm() const { return smallest_mm_; }

 private:
  template <typename Bound>
  void search(const Bound& bound_mm, const Eigen::Vector3d& middle, double half_mm) {
    if (std::min(middle.z() + half_mm, highest_mm_) <= best_mm_ + smallest_mm_) return;
    const double bound = bound_mm(axes_ * middle);
    if (bound > half_mm * std::sqrt(3.0)) return;
    if (bound <= 0.0 && middle.z() > best_mm_) {
      best_mm_ = middle.z();
      best_ = middle;
    }
    if (half_mm < smallest_mm_) return;
    const double half = half_mm / 2.0;
    for (const double z : {half, -half}) {
      for (const double y : {half, -half}) {
        for (const double x : {half, -half}) search(bound_mm, middle + Eigen::Vector3d(x, y, z), half);
      }
    }
  }

  Eigen::Matrix3d axes_;  // columns: across, across, up
  double smallest_mm_;
  double highest_mm_;  // nothing lies higher
  double best_mm_ = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d best_ = Eigen::Vector3d::Zero();
};

}  // namespace

double SolidPart::inset_mm() const { return kInset * solid_->radius_mm(); }

double SolidPart::distance_bound_mm(const Eigen::Vector3d& x_mm) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Cell& cell : cells_) {
    double outside = -std::numeric_limits<double>::infinity();
    for (const auto& plane : cell) outside = std::max(outside, -plane.signedDistance(x_mm));
    nearest = std::min(nearest, outside);
  }
  return std::max(nearest, solid_->distance_bound_mm(x_mm));
}

PartContact SolidPart::contact(const Eigen::Vector3d& direction) const {
  const Contact of_whole = solid_->contact(direction);
  const PartContact whole{of_whole.point_mm, of_whole.on_face, true};
  if (is_whole_ || distance_bound_mm(of_whole.point_mm) <= 1e-9) return whole;
  Eigen::Matrix3d axes;
  axes.col(2) = direction;
  axes.col(0) = direction.unitOrthogonal();
  axes.col(1) = direction.cross(axes.col(0));
  const double highest_mm = of_whole.point_mm.dot(direction);
  const Climb climb([this](const Eigen::Vector3d& x) { return distance_bound_mm(x); }, axes, solid_->radius_mm(),
                    highest_mm);
  if (!climb.found()) return {};
  // A face may lie in the part though its middle does not.
  const bool on_face = of_whole.on_face && climb.height_mm() >= highest_mm - 2.0 * climb.resolution_mm();
  if (on_face) return {climb.point_mm() + (highest_mm - climb.height_mm()) * direction, true, true};
  return {climb.point_mm(), false, false};
}

}  // namespace fathom
