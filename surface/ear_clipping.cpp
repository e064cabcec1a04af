#include "surface/ear_clipping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

namespace fathom {

namespace {

// Of the polygon's extent: the rounding of a corner's place.
constexpr double kFlat = 1e-12;

bool in_triangle(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                 const Eigen::Vector2d& c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

// Whether the way from the corner to `p` begins inside of the polygon.
bool begins_inside(const FlatPolygon& polygon, std::size_t corner, const Eigen::Vector2d& p) {
  const Eigen::Vector2d& before = polygon[(corner + polygon.size() - 1) % polygon.size()].at;
  const Eigen::Vector2d& at = polygon[corner].at;
  const Eigen::Vector2d& next = polygon[(corner + 1) % polygon.size()].at;
  const bool left_of_first = turn(before, at, p) > 0.0;
  const bool left_of_second = turn(at, next, p) > 0.0;
  return turn(before, at, next) >= 0.0 ? left_of_first && left_of_second : left_of_first || left_of_second;
}

// The corner that `from`, which lies inside, sees: looks to the right to the nearest edge, whose right end is seen
// unless a corner stands in front; then the one at the smallest angle is.
std::optional<std::size_t> seen_corner(const FlatPolygon& polygon, const Eigen::Vector2d& from) {
  std::optional<std::size_t> seen;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = (i + 1) % polygon.size();
    const Eigen::Vector2d& a = polygon[i].at;
    const Eigen::Vector2d& b = polygon[next].at;
    if (!(a.y() <= from.y() && b.y() > from.y())) continue;  // the inside is to the left of an edge that rises
    const double x = a.x() + (from.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x < from.x() || x >= nearest) continue;
    nearest = x;
    seen = a.x() > b.x() ? i : next;
  }
  if (!seen) return seen;
  const Eigen::Vector2d target = polygon[*seen].at;
  const Eigen::Vector2d hit(nearest, from.y());
  const bool above = target.y() > from.y();
  double least_slope = std::numeric_limits<double>::infinity();
  double least_way = least_slope;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& p = polygon[i].at;
    if (p.x() < from.x()) continue;
    const bool inside = p == target || (above ? in_triangle(p, from, hit, target) : in_triangle(p, from, target, hit));
    if (!inside || !begins_inside(polygon, i, from)) continue;
    const Eigen::Vector2d way = p - from;
    const double slope = way.x() > 0.0 ? std::abs(way.y()) / way.x() : std::numeric_limits<double>::max();
    if (slope < least_slope || (slope == least_slope && way.squaredNorm() < least_way)) {
      best = i;
      least_slope = slope;
      least_way = way.squaredNorm();
    }
  }
  return best;
}

std::size_t rightmost(const FlatPolygon& polygon) {
  const auto left = [](const FlatCorner& a, const FlatCorner& b) { return a.at.x() < b.at.x(); };
  return static_cast<std::size_t>(std::max_element(polygon.begin(), polygon.end(), left) - polygon.begin());
}

class EarClipper {
 public:
  explicit EarClipper(const FlatPolygon& polygon) : polygon_(polygon), corners_(polygon.size()) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      corners_[i].before = (i + n - 1) % n;
      corners_[i].next = (i + 1) % n;
    }
    Eigen::AlignedBox2d box;
    for (const FlatCorner& corner : polygon) box.extend(corner.at);
    flat_ = kFlat * box.diagonal().norm();
    for (std::size_t i = 0; i < n; ++i) {
      consider(i);
      if (corners_[i].bend <= 0.0) reflex_.push_back(i);
    }
  }

  std::vector<Mesh::Triangle> run() {
    std::size_t left = corners_.size();
    bool any_since = false;  // whether an ear was cut since the blocked ones were last looked at
    while (left >= 3) {
      if (queue_.empty()) {
        if (blocked_.empty()) break;
        if (!any_since) {
          cut(least_bad());
          --left;
        }
        for (const std::size_t i : std::exchange(blocked_, {})) {
          if (!corners_[i].gone) consider(i);
        }
        any_since = false;
        continue;
      }
      const Candidate candidate = queue_.top();
      queue_.pop();
      const Corner& corner = corners_[candidate.corner];
      if (corner.gone || corner.stamp != candidate.stamp) continue;
      if (!is_ear(candidate.corner)) {
        blocked_.push_back(candidate.corner);
        continue;
      }
      cut(candidate.corner);
      --left;
      any_since = true;
    }
    return std::move(triangles_);
  }

 private:
  struct Corner {
    std::size_t before = 0;
    std::size_t next = 0;
    double bend = 0.0;  // twice the area of the ear, negative where the polygon is not convex
    int stamp = 0;
    bool gone = false;
  };
  struct Candidate {
    double quality = 0.0;
    std::size_t corner = 0;
    int stamp = 0;
    bool operator<(const Candidate& other) const {
      return quality != other.quality ? quality < other.quality : corner > other.corner;
    }
  };

  const Eigen::Vector2d& at(std::size_t i) const { return polygon_[i].at; }

  // A spike without width, or the same place twice: may go, whatever lies around.
  bool is_spike(std::size_t i) const {
    const Eigen::Vector2d back = at(corners_[i].before) - at(i);
    const Eigen::Vector2d on = at(corners_[i].next) - at(i);
    return back.dot(on) >= 0.0 && std::abs(corners_[i].bend) <= flat_ * std::max(back.norm(), on.norm());
  }

  // Area over squared edges: largest where equilateral. Spikes come first.
  double quality(std::size_t i) const {
    const Corner& corner = corners_[i];
    if (is_spike(i)) return std::numeric_limits<double>::infinity();
    const double edges = (at(i) - at(corner.before)).squaredNorm() + (at(corner.next) - at(i)).squaredNorm() +
                         (at(corner.next) - at(corner.before)).squaredNorm();
    return edges > 0.0 ? corner.bend / edges : 0.0;
  }

  void consider(std::size_t i) {
    Corner& corner = corners_[i];
    corner.bend = turn(at(corner.before), at(i), at(corner.next));
    queue_.push({quality(i), i, ++corner.stamp});
  }

  bool is_ear(std::size_t i) {
    const Corner& corner = corners_[i];
    if (polygon_[corner.before].vertex == polygon_[corner.next].vertex) return false;
    if (is_spike(i)) return true;
    if (corner.bend <= 0.0) return false;
    const Eigen::Vector2d& a = at(corner.before);
    const Eigen::Vector2d& b = at(i);
    const Eigen::Vector2d& c = at(corner.next);
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c);
    const Eigen::Vector2d high = a.cwiseMax(b).cwiseMax(c);
    // Only a corner that is not convex can be the first to stand in an ear. Corners never become less convex.
    std::erase_if(reflex_, [this](std::size_t k) { return corners_[k].gone || corners_[k].bend > 0.0; });
    return std::none_of(reflex_.begin(), reflex_.end(), [&](std::size_t k) {
      const Eigen::Vector2d& p = at(k);
      if (p.x() < low.x() || p.x() > high.x() || p.y() < low.y() || p.y() > high.y()) return false;
      if (p == a) return leads_between(k, a, b, c);
      if (p == b) return leads_between(k, b, c, a);
      if (p == c) return leads_between(k, c, a, b);
      return in_triangle(p, a, b, c);
    });
  }

  // Whether the polygon, which comes to the corner at `tip` once more, runs on into the angle from `right` to `left`.
  bool leads_between(std::size_t k, const Eigen::Vector2d& tip, const Eigen::Vector2d& right,
                     const Eigen::Vector2d& left) const {
    const auto is_between = [&](std::size_t other) {
      return turn(tip, right, at(other)) > 0.0 && turn(tip, left, at(other)) < 0.0;
    };
    return is_between(corners_[k].before) || is_between(corners_[k].next);
  }

  std::size_t least_bad() const {
    const auto worse = [this](std::size_t i, std::size_t j) {
      const auto key = [this](std::size_t k) {
        const Corner& corner = corners_[k];
        const bool folds = polygon_[corner.before].vertex == polygon_[corner.next].vertex;
        return std::tuple(!corner.gone, !folds, corner.bend);
      };
      return key(i) < key(j);
    };
    return *std::max_element(blocked_.begin(), blocked_.end(), worse);
  }

  void cut(std::size_t i) {
    Corner& corner = corners_[i];
    triangles_.push_back({polygon_[corner.before].vertex, polygon_[i].vertex, polygon_[corner.next].vertex});
    corner.gone = true;
    corners_[corner.before].next = corner.next;
    corners_[corner.next].before = corner.before;
    for (const std::size_t neighbour : {corner.before, corner.next}) {
      const bool was_convex = corners_[neighbour].bend > 0.0;
      consider(neighbour);
      if (was_convex && corners_[neighbour].bend <= 0.0) reflex_.push_back(neighbour);  // by rounding
    }
  }

  const FlatPolygon& polygon_;
  double flat_ = 0.0;  // mm
  std::vector<Corner> corners_;
  std::vector<std::size_t> reflex_;
  std::vector<std::size_t> blocked_;
  std::priority_queue<Candidate> queue_;
  std::vector<Mesh::Triangle> triangles_;
};

}  // namespace

double signed_area(const FlatPolygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += turn(polygon[0].at, polygon[i - 1].at, polygon[i].at);
  return 0.5 * twice;
}

std::optional<FlatPolygon> bridge_holes(FlatPolygon outer, std::vector<FlatPolygon> holes) {
  for (FlatPolygon& hole : holes) {
    std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(rightmost(hole)), hole.end());
  }
  // From the right, so that no hole stands between one and the outline.
  std::stable_sort(holes.begin(), holes.end(),
                   [](const FlatPolygon& a, const FlatPolygon& b) { return a.front().at.x() > b.front().at.x(); });
  for (const FlatPolygon& hole : holes) {
    const auto corner = seen_corner(outer, hole.front().at);
    if (!corner) return {};
    FlatPolygon there = hole;
    there.push_back(hole.front());
    there.push_back(outer[*corner]);
    outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(*corner) + 1, there.begin(), there.end());
  }
  return outer;
}

std::vector<Mesh::Triangle> clip_ears(const FlatPolygon& polygon) { return EarClipper(polygon).run(); }

}  // namespace fathom
