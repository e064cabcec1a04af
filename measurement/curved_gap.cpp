#include "measurement/curved_gap.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

namespace fathom {

namespace {

// Planes nearer than this to each other, as a share of the distance of this gap's, tell more of how the outlines were
// drawn than of how the structure bends.
constexpr double kNearPlanes = 0.2;

// Of the deepest point of both sections: no structure bulges by more between two sections that describe it.
constexpr float kMostBulge = 1.0F;
// Of the distance of the planes: half-way between them the surface moves by no more than half of it.
constexpr float kMostBulgePerGap = 2.0F;

// Nodes are this many column steps of the lattice apart.
constexpr double kNodeSteps = 4.0;

bool is_absent(const PlacedSection& section) { return section.shape->kind() == SectionKind::kAbsent; }

// Where lines through points on one of the gap's planes meet its other one, in the direction of `sign`. The guide tells
// vectors for the middle of a line, which lies half of it away.
std::vector<Eigen::Vector2d> followed(const SectionGap& gap, const std::vector<Eigen::Vector2d>& from_mm, double sign) {
  std::vector<Eigen::Vector2d> to_mm = gap.correspondences_mm(from_mm);
  for (std::size_t k = 0; k < to_mm.size(); ++k) to_mm[k] = from_mm[k] + 0.5 * sign * to_mm[k];
  to_mm = gap.correspondences_mm(to_mm);
  for (std::size_t k = 0; k < to_mm.size(); ++k) to_mm[k] = from_mm[k] + sign * to_mm[k];
  return to_mm;
}

// The second divided difference of three values, the outer ones `before` and `behind` away from the middle one.
template <typename T>
T bend(const T& first, const T& middle, const T& last, double before, double behind) {
  return ((last - middle) / behind - (middle - first) / before) / (before + behind);
}

Eigen::Vector2d gradient(const SectionShape& shape, const Eigen::Vector2d& ab_mm) {
  const Eigen::Vector2f at = shape.in_cells(ab_mm);
  const Eigen::Vector2f i = Eigen::Vector2f::UnitX();
  const Eigen::Vector2f j = Eigen::Vector2f::UnitY();
  const Eigen::Vector2f rise(shape.distance_at_mm(at + i) - shape.distance_at_mm(at - i),
                             shape.distance_at_mm(at + j) - shape.distance_at_mm(at - j));
  return rise.cast<double>() / (2.0 * shape.cell_mm());
}

// Both sides' say.
double agreed(const std::optional<double>& one, const std::optional<double>& other) {
  if (!one || !other) return one ? *one : other.value_or(0.0);
  if (*one * *other <= 0.0) return 0.0;
  const double smaller = std::min(std::abs(*one), std::abs(*other));
  const double mean = 0.5 * (*one + *other);
  return std::copysign(std::min(std::abs(mean), 2.0 * smaller), mean);
}

}  // namespace

// A point on each of three planes.
struct CurvedGap::Triple {
  const PlacedSection& first;
  const PlacedSection& middle;
  const PlacedSection& last;
  Eigen::Vector2d first_mm;
  Eigen::Vector2d middle_mm;
  Eigen::Vector2d last_mm;

  // How much the distance rises above the straight line from the middle to the last point, or to the first one. Heights
  // over the middle plane tell how far along the line the points are: then how it bends lies within that plane, where
  // the gradient of the distance is known.
  std::optional<double> bulge_mm(bool to_last) const {
    if (is_absent(first) || is_absent(last)) return std::nullopt;
    const Eigen::Vector3d at = middle.plane.at(middle_mm);
    const Eigen::Vector3d from = first.plane.at(first_mm) - at;
    const Eigen::Vector3d to = last.plane.at(last_mm) - at;
    const double before = -from.dot(middle.plane.normal());
    const double behind = to.dot(middle.plane.normal());
    const double gap = to_last ? behind : before;
    const double side = to_last ? before : behind;
    if (gap * side <= 0.0 || std::abs(side) <= kNearPlanes * std::abs(gap)) return std::nullopt;
    const double distance_bend = bend<double>(first.shape->distance_mm(first_mm), middle.shape->distance_mm(middle_mm),
                                              last.shape->distance_mm(last_mm), before, behind);
    const auto within = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector2d(v.dot(middle.plane.a_axis), v.dot(middle.plane.b_axis));
    };
    const Eigen::Vector2d line_bend =
        bend<Eigen::Vector2d>(within(from), Eigen::Vector2d::Zero(), within(to), before, behind);
    return -gap * gap * (distance_bend - gradient(*middle.shape, middle_mm).dot(line_bend));
  }
};

CurvedGap::CurvedGap(const SectionGap& gap, const SectionGap* before, const SectionGap* after)
    : gap_(gap),
      before_(before),
      after_(after),
      deepest_mm_(std::max(gap.first().shape->largest_inside_mm(), gap.second().shape->largest_inside_mm())) {
  assert(!before || before->second().shape == gap.first().shape);
  assert(!after || after->first().shape == gap.second().shape);
  assert(gap.guide() != Guide::kCentroids);
}

float CurvedGap::most_mm(const Eigen::Vector2d& ab_mm) const {
  const auto apart = static_cast<float>(std::abs(gap_.ahead_mm(ab_mm)));
  return std::min(kMostBulge * deepest_mm_, kMostBulgePerGap * apart);
}

std::vector<float> CurvedGap::bulges_mm(const std::vector<Eigen::Vector2d>& ab_mm) const {
  std::vector<float> bulges(ab_mm.size(), 0.0F);
  if (is_absent(gap_.first()) || is_absent(gap_.second())) return bulges;
  std::vector<Eigen::Vector2d> on_first = gap_.correspondences_mm(ab_mm);
  std::vector<Eigen::Vector2d> on_second = on_first;
  for (std::size_t k = 0; k < ab_mm.size(); ++k) {
    on_first[k] = ab_mm[k] - 0.5 * on_first[k];
    on_second[k] = ab_mm[k] + 0.5 * on_second[k];
  }
  std::vector<Eigen::Vector2d> on_before;
  std::vector<Eigen::Vector2d> on_after;
  if (before_) on_before = followed(*before_, on_first, -1.0);
  if (after_) on_after = followed(*after_, on_second, 1.0);
  for (std::size_t k = 0; k < ab_mm.size(); ++k) {
    std::optional<double> one;
    std::optional<double> other;
    if (before_) {
      one =
          Triple{before_->first(), gap_.first(), gap_.second(), on_before[k], on_first[k], on_second[k]}.bulge_mm(true);
    }
    if (after_) {
      other =
          Triple{gap_.first(), gap_.second(), after_->second(), on_first[k], on_second[k], on_after[k]}.bulge_mm(false);
    }
    const float most = most_mm(ab_mm[k]);
    bulges[k] = std::clamp(static_cast<float>(agreed(one, other)), -most, most);
  }
  return bulges;
}

float CurvedGap::bulge_mm(const Eigen::Vector2d& ab_mm) const { return bulges_mm({ab_mm}).front(); }

float CurvedGap::value_mm(const Eigen::Vector2d& ab_mm, double u) const {
  const float share = gap_.bulge_share(ab_mm, u);
  return share > 0.0F ? gap_.value_mm(ab_mm, u) + share * bulge_mm(ab_mm) : gap_.value_mm(ab_mm, u);
}

GapBulges CurvedGap::bulges(const ColumnGrid& grid) const {
  GapBulges bulges;
  bulges.pitch_mm = kNodeSteps * grid.column_step_mm.norm();
  const Eigen::Vector2d last =
      grid.start_mm + (grid.columns - 1) * grid.column_step_mm + (grid.rows - 1) * grid.row_step_mm;
  const auto node = [&bulges](double mm) { return static_cast<int>(std::floor(mm / bulges.pitch_mm)); };
  bulges.first_column = node(grid.start_mm.x());
  bulges.first_row = node(grid.start_mm.y());
  // Rows of one parity reach half a step farther.
  bulges.columns = node(last.x() + 0.5 * grid.column_step_mm.x()) + 2 - bulges.first_column;
  bulges.rows = node(last.y()) + 2 - bulges.first_row;
  bulges.values_mm.assign(bulges.index(0, bulges.rows), 0.0F);

  // A column that the surface may cross lies in a cell with these nodes.
  const double reach = gap_.certain_mm(grid) + 2.0 * std::numbers::sqrt2 * bulges.pitch_mm;
  std::vector<Eigen::Vector2d> nodes;
  std::vector<std::size_t> places;
  for (int j = 0; j < bulges.rows; ++j) {
    for (int i = 0; i < bulges.columns; ++i) {
      const Eigen::Vector2d ab = bulges.node_mm(i, j);
      if (!gap_.may_cross(ab, reach + 0.25 * most_mm(ab))) continue;
      nodes.push_back(ab);
      places.push_back(bulges.index(i, j));
    }
  }
  const std::vector<float> values = bulges_mm(nodes);
  for (std::size_t k = 0; k < places.size(); ++k) bulges.values_mm[places[k]] = values[k];
  bulges.find_most();
  return bulges;
}

}  // namespace fathom
