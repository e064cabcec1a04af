#include "measurement/tapered_end.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "measurement/cross_section.h"
#include "measurement/section_parts.h"

namespace fathom {

namespace {

constexpr double kLeastShare = 1e-4;   // of the section's area: smaller is nothing
constexpr double kTipMargin = 0.05;    // a tip that is not touched lies so far from both planes at least
constexpr double kDoubtOfNoTip = 3.0;  // where nothing tells where it ends
constexpr double kLeastBall = 0.02;
constexpr double kMostOfEven = 1.3;  // by which the area of a part of even thickness grows at most

double area_of(const SectionShape& shape) {
  std::vector<const Polygon*> polygons;
  for (const Polygon& outline : shape.outlines_mm()) polygons.push_back(&outline);
  return even_odd_area(polygons).area_px2;
}

/// The distance, far outside a bound of it that is found at once.
double distance_or_less_mm(const SectionShape& shape, const Eigen::Vector2d& ab_mm) {
  const double outside = shape.least_outside_mm(ab_mm);
  if (outside > 0.0) return -outside - kRasterMargin * shape.cell_mm();
  return static_cast<double>(shape.distance_mm(ab_mm));
}

/// A part on a section farther from the end.
struct Farther {
  double w = 0.0;
  double area = 0.0;
  Eigen::Vector2d centre_mm = Eigen::Vector2d::Zero();
};

/// Where a plane lies on the way from the end (0) to the first section (1), at a point of that.
double way_to(const SectionPlane& plane, const SectionPlane& end, const SectionPlane& first,
              const Eigen::Vector2d& ab_mm) {
  const Eigen::Vector3d normal = first.normal();
  const Eigen::Vector3d at = first.at(ab_mm);
  const double behind = normal.dot(end.at(ab_mm) - at);
  return std::abs(behind) < 1e-9 ? 1.0 : 1.0 - normal.dot(plane.at(ab_mm) - at) / behind;
}

/// The part of the next section that goes on from one of `parts`: the only one that overlaps it, or where both sections
/// have as many the nearest. Null where it divides or meets others.
const SectionPart* continued(const std::vector<SectionPart>& parts, std::size_t own,
                             const std::vector<SectionPart>& next) {
  std::vector<const SectionPart*> found;
  for (const SectionPart& candidate : next) {
    if (parts_meet(parts[own], candidate)) found.push_back(&candidate);
  }
  const auto meets = [&](const SectionPart& part) { return parts_meet(part, *found.front()); };
  if (found.size() == 1 && std::count_if(parts.begin(), parts.end(), meets) == 1) return found.front();
  if (parts.size() != next.size()) return nullptr;
  const auto off = [&](const SectionPart& part) { return (part.centroid_mm - parts[own].centroid_mm).squaredNorm(); };
  return &*std::min_element(next.begin(), next.end(),
                            [&](const SectionPart& a, const SectionPart& b) { return off(a) < off(b); });
}

/// Where a part that nothing touches ends, and how that is doubted.
struct Tip {
  double way = 0.5;
  double doubt = kDoubtOfNoTip;
  bool found = false;
};

/// The tip of the parabola through the areas, or of the straight line through two of them. Where it lies beyond the
/// planes, the nearer one: more is not known then. Half-way where there is none. `known` starts with the nearest
/// section, at 1.
Tip tip_of(const std::vector<Farther>& known) {
  if (known.size() < 2) return {};
  const double rise = (known[1].area - known[0].area) / (known[1].w - known[0].w);
  double bend = 0.0;
  if (known.size() > 2) {
    const double rise_beyond = (known[2].area - known[1].area) / (known[2].w - known[1].w);
    bend = (rise_beyond - rise) / (known[2].w - known[0].w);
  }
  // A + slope t + bend t^2 = 0, t back from the section.
  const double slope = rise - bend * (known[1].w - known[0].w);
  if (!(slope > 0.0)) return {};
  const double root = slope * slope - 4.0 * bend * known[0].area;
  const double back = root < 0.0 ? slope / (2.0 * bend) : 2.0 * known[0].area / (slope + std::sqrt(root));
  const bool between = back < 1.0;
  return {std::clamp(1.0 - back, kTipMargin, 1.0 - kTipMargin), between ? 1.0 : kDoubtOfNoTip, true};
}

/// Whether a part whose tip is at 0 keeps its area rather than shrinks to another end, as the third of `sections`
/// tells: nearer to the first one's area than to the parabola's. Without a third section the structure ends there.
bool goes_on(const std::vector<Farther>& known, std::size_t sections) {
  if (known.size() < 3) return sections > 2;
  const double w2 = known[1].w;
  const double w3 = known[2].w;
  const double bend = (known[1].area / w2 - known[0].area) / (w2 - 1.0);
  const double parabola = w3 * (known[0].area + bend * (w3 - 1.0));
  return std::abs(known[2].area - known[0].area) < std::abs(known[2].area - parabola);
}

}  // namespace

double TaperedEnd::Part::share_of_area(double w) const {
  const double from_tip = std::min(1.0, (w - tip) / (1.0 - tip) / grown);
  return from_tip * (slope + bend * from_tip);
}

Eigen::Vector2d TaperedEnd::Part::centre_at(double w) const {
  return centre_mm + (w - 1.0) * (centre_slope_mm + w * centre_bend_mm);
}

double TaperedEnd::Part::value_mm(const Eigen::Vector2d& ab_mm, double w) const {
  const Eigen::Vector2d off = ab_mm - centre_at(std::max(w, tip));
  const double share = w > tip ? share_of_area(w) : 0.0;
  if (share < kLeastShare) {
    const double beyond = std::sqrt(std::max(0.0, tip - w) / (1.0 - tip));
    return -off.norm() - beyond * static_cast<double>(shape->largest_inside_mm());
  }
  const double scale = std::sqrt(share);
  return scale * distance_or_less_mm(*shape, centre_mm + off / scale);
}

TaperedEnd::TaperedEnd(const PlacedSection& end, std::span<const PlacedSection> sections) {
  assert(!sections.empty());
  sections = sections.first(std::min<std::size_t>(3, sections.size()));
  const SectionPlane& first = sections.front().plane;
  std::vector<std::vector<SectionPart>> all;
  for (const PlacedSection& section : sections) all.push_back(section_parts(section.shape));
  const bool point = end.shape->kind() == SectionKind::kPoint;
  const Eigen::Vector2d point_mm = point ? end.shape->raster().origin_mm : Eigen::Vector2d::Zero();
  const auto to_point = [&](const SectionPart& part) { return part.shape->distance_mm(point_mm); };
  const auto touched = std::max_element(all[0].begin(), all[0].end(), [&](const SectionPart& a, const SectionPart& b) {
    return to_point(a) < to_point(b);
  });
  for (std::size_t i = 0; i < all[0].size(); ++i) {
    const SectionPart* own = &all[0][i];
    std::vector<Farther> known = {{1.0, area_of(*own->shape), own->centroid_mm}};
    std::size_t at = i;
    for (std::size_t k = 1; k < sections.size(); ++k) {
      const SectionPart* next = continued(all[k - 1], at, all[k]);
      const double w = way_to(sections[k].plane, end.plane, first, own->centroid_mm);
      if (next == nullptr || !(w > known.back().w + 0.1)) break;
      known.push_back({w, area_of(*next->shape), next->centroid_mm});
      at = static_cast<std::size_t>(next - all[k].data());
    }
    const bool is_touched = point && own == &*touched;
    // What grows faster than a paraboloid has joined something.
    if (is_touched && known.size() > 1 && known[1].area > known[1].w * known[0].area) known.resize(1);
    Part part;
    part.shape = own->shape;
    part.centre_mm = own->centroid_mm;
    const Tip tip = is_touched ? Tip{0.0, 1.0, true} : tip_of(known);
    part.tip = tip.way;
    part.doubt = tip.doubt;
    const bool more = known.size() > 1;
    if (more) {
      // Through the tip and two sections.
      const double w2 = (known[1].w - part.tip) / (1.0 - part.tip);
      part.bend = std::clamp((known[1].area / known[0].area - w2) / (w2 * (w2 - 1.0)), -1.0, 1.0);
      part.slope = 1.0 - part.bend;
      part.centre_slope_mm = (known[1].centre_mm - known[0].centre_mm) / (known[1].w - 1.0);
    }
    // Half a ball, as far as the part leans.
    const double ahead_mm = std::abs(first.normal().dot(end.plane.at(own->centroid_mm) - first.at(own->centroid_mm)));
    const double aside_mm = part.centre_slope_mm.norm();
    const double lean = aside_mm / std::max(1e-9, std::hypot(aside_mm, ahead_mm));
    const double ball = static_cast<double>(own->shape->largest_inside_mm()) * (1.0 + lean) /
                        std::max(1e-9, ahead_mm * (1.0 - part.tip));
    part.ball = std::clamp(ball * (1.0 - part.tip), kLeastBall, 1.0);
    const bool even =
        ball < 1.0 &&
        (!more || (is_touched ? goes_on(known, sections.size()) : known[1].area < kMostOfEven * known[0].area));
    part.open = !is_touched && (even || !tip.found);
    if (even) {
      part.grown = ball;
      part.slope = 2.0;
      part.bend = -1.0;
    }
    if (is_touched) {
      const Eigen::Vector2d slope = own->centroid_mm - point_mm;
      if (more) part.centre_bend_mm = (part.centre_slope_mm - slope) / known[1].w;
      part.centre_slope_mm = slope;
    }
    parts_.push_back(std::move(part));
  }
}

TaperedEnd::Value TaperedEnd::value_mm(const Eigen::Vector2d& ab_mm, double w) const {
  Value best;
  for (const Part& part : parts_) {
    const auto distance_mm = static_cast<float>(part.value_mm(ab_mm, w));
    if (distance_mm <= best.distance_mm) continue;
    best = {distance_mm, static_cast<float>(part.doubt) * part.shape->largest_inside_mm()};
  }
  return best;
}

std::vector<TaperedEnd::OpenPart> TaperedEnd::open_parts() const {
  std::vector<OpenPart> open;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].open) open.push_back({i, parts_[i].shape, parts_[i].centre_slope_mm});
  }
  return open;
}

void TaperedEnd::end_at(std::size_t index, double tip) {
  Part& part = parts_[index];
  part.tip = std::clamp(tip, kTipMargin, 1.0 - kTipMargin);
  part.grown = std::min(1.0, part.ball / (1.0 - part.tip));
  part.slope = 2.0;
  part.bend = -1.0;
  part.doubt = 1.0;
}

}  // namespace fathom
