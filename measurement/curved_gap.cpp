#include "measurement/curved_gap.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

namespace fathom {

namespace {

// Planes nearer than this to each other, as a share of the distance of this gap's, tell more of how the outlines were
// drawn than of how the structure bends.
constexpr double kNearPlanes = 0.2;

// Of the deepest point of both sections: no structure bulges by more between two sections that describe it.
constexpr float kMostBulge = 1.0F;

bool is_absent(const PlacedSection& section) { return section.shape->kind() == SectionKind::kAbsent; }

// The vector of a line through `at` on one of the gap's planes; the guide tells it for the middle of the line, which
// lies half of it away, in the direction of `sign`.
Eigen::Vector2d vector_from(const SectionGap& gap, const Eigen::Vector2d& at, double sign) {
  const Eigen::Vector2d guess = gap.correspondence_mm(at);
  return gap.correspondence_mm(at + 0.5 * sign * guess);
}

// The second divided difference of three values, the outer ones `before` and `behind` away from the middle one.
double bend(double first, double middle, double last, double before, double behind) {
  return ((last - middle) / behind - (middle - first) / before) / (before + behind);
}

}  // namespace

CurvedGap::CurvedGap(const SectionGap& gap, const SectionGap* before, const SectionGap* after)
    : gap_(gap),
      before_(before),
      after_(after),
      most_mm_(kMostBulge * std::max(gap.first().shape->largest_inside_mm(), gap.second().shape->largest_inside_mm())) {
  assert(!before || before->second().shape == gap.first().shape);
  assert(!after || after->first().shape == gap.second().shape);
}

float CurvedGap::bulge_mm(const Eigen::Vector2d& ab_mm) const {
  if (is_absent(gap_.first()) || is_absent(gap_.second())) return 0.0F;
  const double apart = gap_.ahead_mm(ab_mm);
  const Eigen::Vector2d c = gap_.correspondence_mm(ab_mm);
  const Eigen::Vector2d on_first = ab_mm - 0.5 * c;
  const Eigen::Vector2d on_second = ab_mm + 0.5 * c;
  const double d1 = gap_.first().shape->distance_mm(on_first);
  const double d2 = gap_.second().shape->distance_mm(on_second);
  const auto tells = [&](const PlacedSection& far, double side_apart) {
    return !is_absent(far) && apart * side_apart > 0.0 && std::abs(side_apart) > kNearPlanes * std::abs(apart);
  };
  std::array<std::optional<double>, 2> bends;
  if (before_) {
    const double side = before_->ahead_mm(on_first);
    if (tells(before_->first(), side)) {
      const Eigen::Vector2d at = on_first - vector_from(*before_, on_first, -1.0);
      bends[0] = bend(before_->first().shape->distance_mm(at), d1, d2, side, apart);
    }
  }
  if (after_) {
    const double side = after_->ahead_mm(on_second);
    if (tells(after_->second(), side)) {
      const Eigen::Vector2d at = on_second + vector_from(*after_, on_second, 1.0);
      bends[1] = bend(d1, d2, after_->second().shape->distance_mm(at), apart, side);
    }
  }
  double both = 0.0;
  if (bends[0] && bends[1]) {
    if (*bends[0] * *bends[1] > 0.0) {
      const double smaller = std::min(std::abs(*bends[0]), std::abs(*bends[1]));
      const double mean = 0.5 * (*bends[0] + *bends[1]);
      both = std::copysign(std::min(std::abs(mean), 2.0 * smaller), mean);
    }
  } else if (bends[0] || bends[1]) {
    both = bends[0] ? *bends[0] : *bends[1];
  }
  return std::clamp(static_cast<float>(-both * apart * apart), -most_mm_, most_mm_);
}

float CurvedGap::value_mm(const Eigen::Vector2d& ab_mm, double u) const {
  const float linear = gap_.value_mm(ab_mm, u);
  const auto share = static_cast<float>(u * (1.0 - u));
  return share > 0.0F ? linear + share * bulge_mm(ab_mm) : linear;
}

}  // namespace fathom
