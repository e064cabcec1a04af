#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "sim/open_at_border.h"
#include "sim/section.h"
#include "sim/thin_polygon.h"

// Outlines in three steps: cells of a fine grid that the surface may cross are found from coarse to fine, by the
// distance bound; marching squares over them, with each crossing found to rounding, gives closed lines whose points
// all lie on the surface; lines are then refined where they turn sharply (corners, tiny sections) and thinned where
// they are nearly straight.

namespace fathom {

namespace {

constexpr int kLevels = 9;             // the finest cells are 1/512 of the square that holds the section
constexpr int kCells = 1 << kLevels;   // along each side
constexpr double kMaxSagitta = 2e-3;   // of an edge's length: polygons that turn by 1 degree a point lose 5e-5 of area
constexpr int kMaxRefinements = 14;    // halvings of an edge: corners are met to 1/16000 of a cell
constexpr double kThinning = 1e-4;     // of area / perimeter: thinning changes the area by less than 1e-4
constexpr double kShortest_mm = 1e-7;  // edges this short are left alone: rounding decides their direction
constexpr std::uint32_t kRowStride = 1 << 16;

/// The solid's bound along a plane, in millimetres of that plane, or that of what a rectangle shows of it.
struct PlaneField {
  const Solid& solid;
  Eigen::Vector3d origin;
  Eigen::Vector3d u;
  Eigen::Vector3d v;
  std::optional<Eigen::AlignedBox2d> window;

  double operator()(const Eigen::Vector2d& p) const {
    const double bound = solid.distance_bound_mm(origin + p.x() * u + p.y() * v);
    if (!window) return bound;
    const Eigen::Vector2d outside = (p - window->center()).cwiseAbs() - 0.5 * window->sizes();
    return std::max(bound, outside.maxCoeff());
  }
};

/// Where the surface crosses the segment from `a` to `b`, given values of different sides at the ends: false position
/// with a halved weight for the end that stays (the Illinois rule), which keeps the root bracketed.
Eigen::Vector2d crossing(const PlaneField& field, Eigen::Vector2d a, double fa, Eigen::Vector2d b, double fb) {
  constexpr double kTolerance_mm = 1e-12;
  int last_side = 0;
  Eigen::Vector2d x = a;
  for (int i = 0; i < 60; ++i) {
    x = a + (b - a) * (fa / (fa - fb));
    const double fx = field(x);
    if (std::abs(fx) < kTolerance_mm) break;
    const int side = (fx <= 0.0) == (fa <= 0.0) ? 1 : -1;
    if (side > 0) {
      a = x;
      fa = fx;
      if (last_side > 0) fb /= 2.0;
    } else {
      b = x;
      fb = fx;
      if (last_side < 0) fa /= 2.0;
    }
    last_side = side;
  }
  return x;
}

class Marcher {
 public:
  Marcher(const PlaneField& field, double half_side_mm)
      : field_(field), half_side_mm_(half_side_mm), cell_mm_(2.0 * half_side_mm / kCells) {}

  std::vector<Polygon> lines() {
    visit(0, 0, kCells);
    return linked();
  }

 private:
  using Key = std::uint32_t;

  Eigen::Vector2d corner(double i, double j) const {
    return {i * cell_mm_ - half_side_mm_, j * cell_mm_ - half_side_mm_};
  }

  void visit(int i, int j, int size) {
    const double centre = field_(corner(i + size / 2.0, j + size / 2.0));
    if (std::abs(centre) > size * cell_mm_ * std::sqrt(0.5)) return;
    if (size == 1) {
      march(i, j, centre);
      return;
    }
    const int half = size / 2;
    visit(i, j, half);
    visit(i + half, j, half);
    visit(i, j + half, half);
    visit(i + half, j + half, half);
  }

  double value(int i, int j) {
    const auto [entry, is_new] = values_.try_emplace(static_cast<Key>(j) * kRowStride + static_cast<Key>(i), 0.0);
    if (is_new) entry->second = field_(corner(i, j));
    return entry->second;
  }

  /// Index of the crossing on a grid edge: `upward` from (i, j) to (i, j + 1), else to (i + 1, j).
  int point_on(int i, int j, bool upward) {
    const Key key = (static_cast<Key>(j) * kRowStride + static_cast<Key>(i)) * 2 + (upward ? 1 : 0);
    const auto [entry, is_new] = point_of_edge_.try_emplace(key, static_cast<int>(points_.size()));
    if (is_new) {
      const int i1 = upward ? i : i + 1;
      const int j1 = upward ? j + 1 : j;
      points_.push_back(crossing(field_, corner(i, j), value(i, j), corner(i1, j1), value(i1, j1)));
      next_.push_back(-1);
    }
    return entry->second;
  }

  void march(int i, int j, double centre) {
    const std::array<double, 4> values = {value(i, j), value(i + 1, j), value(i + 1, j + 1), value(i, j + 1)};
    std::array<bool, 4> inside;
    for (std::size_t k = 0; k < 4; ++k) inside[k] = values[k] <= 0.0;
    // Edge k runs from corner k to corner k + 1, counter-clockwise around the cell.
    const auto point = [&](std::size_t edge) {
      switch (edge) {
        case 0:
          return point_on(i, j, false);
        case 1:
          return point_on(i + 1, j, true);
        case 2:
          return point_on(i, j + 1, false);
        default:
          return point_on(i, j, true);
      }
    };
    // A line enters where the edge leaves the inside and leaves where the edge next enters it: inside on the left.
    std::array<std::size_t, 4> out{};
    std::array<std::size_t, 4> in{};
    std::size_t count = 0;
    std::size_t count_in = 0;
    for (std::size_t edge = 0; edge < 4; ++edge) {
      const bool from = inside[edge];
      const bool to = inside[(edge + 1) % 4];
      if (from && !to) out[count++] = edge;
      if (!from && to) in[count_in++] = edge;
    }
    if (count == 1) {
      next_[static_cast<std::size_t>(point(out[0]))] = point(in[0]);
    } else if (count == 2) {
      // Opposite corners inside: the centre tells whether they are joined.
      const bool joined = centre <= 0.0;
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t edge = out[k];
        const std::size_t end = joined ? (edge + 1) % 4 : (edge + 3) % 4;
        next_[static_cast<std::size_t>(point(edge))] = point(end);
      }
    }
  }

  std::vector<Polygon> linked() const {
    std::vector<Polygon> result;
    std::vector<bool> used(points_.size(), false);
    for (std::size_t start = 0; start < points_.size(); ++start) {
      if (used[start]) continue;
      Polygon line;
      std::size_t at = start;
      while (!used[at]) {
        used[at] = true;
        // Where the surface passes through a grid point, several edges give the same point.
        if (line.empty() || (line.back() - points_[at]).norm() > kShortest_mm) line.push_back(points_[at]);
        if (next_[at] < 0) break;
        at = static_cast<std::size_t>(next_[at]);
      }
      if (line.size() >= 3) result.push_back(std::move(line));
    }
    return result;
  }

  const PlaneField& field_;
  double half_side_mm_;
  double cell_mm_;
  std::unordered_map<Key, double> values_;
  std::unordered_map<Key, int> point_of_edge_;
  Polygon points_;
  std::vector<int> next_;
};

/// Appends what lies between `a` (already there) and `b` (not appended): points on the surface beside the edge.
void refine_edge(const PlaneField& field, const Eigen::Vector2d& a, const Eigen::Vector2d& b, int refinements,
                 Polygon& line) {
  const Eigen::Vector2d middle = (a + b) / 2.0;
  const Eigen::Vector2d along = b - a;
  const double length = along.norm();
  if (refinements == 0 || length < kShortest_mm) return;
  const Eigen::Vector2d outward(along.y() / length, -along.x() / length);  // the inside is on the left
  const double at_middle = field(middle);
  const double side = at_middle <= 0.0 ? 1.0 : -1.0;
  // The bound is a lower one: step on until the surface is passed, but no farther than the edge is long.
  double near = 0.0;
  double f_near = at_middle;
  double far = std::max(std::abs(at_middle), length * kMaxSagitta / 4.0);
  std::optional<Eigen::Vector2d> found;
  for (; far < length; far *= 2.0) {
    const Eigen::Vector2d probe = middle + side * far * outward;
    const double f_far = field(probe);
    if ((f_far <= 0.0) != (at_middle <= 0.0)) {
      found = crossing(field, middle + side * near * outward, f_near, probe, f_far);
      break;
    }
    near = far;
    f_near = f_far;
  }
  if (!found || (*found - middle).norm() < kMaxSagitta * length) return;
  refine_edge(field, a, *found, refinements - 1, line);
  line.push_back(*found);
  refine_edge(field, *found, b, refinements - 1, line);
}

Polygon refined(const PlaneField& field, const Polygon& line) {
  Polygon result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    result.push_back(line[i]);
    refine_edge(field, line[i], line[(i + 1) % line.size()], kMaxRefinements, result);
  }
  return result;
}

/// An image's rectangle in pixels; none for all of the plane.
using ImageWindow = std::optional<Eigen::AlignedBox2d>;

std::vector<Polygon> outlines_within(const Solid& solid, const Eigen::Affine3d& solid_from_image,
                                     const ImageWindow& window_px) {
  const Eigen::Vector3d right = solid_from_image.linear().col(0);
  const Eigen::Vector3d down = solid_from_image.linear().col(1);
  const Eigen::Vector3d u = right.normalized();
  const Eigen::Vector3d v = down.normalized();
  // The solid lies in a ball about its origin, so the section lies in a disc about the origin's projection.
  const Eigen::Vector3d normal = u.cross(v);
  const double height = solid_from_image.translation().dot(normal);
  const double squared = solid.radius_mm() * solid.radius_mm() - height * height;
  if (squared <= 0.0) return {};
  const Eigen::Vector2d scale(right.norm(), down.norm());
  const Eigen::Vector2d origin(solid_from_image.translation().dot(u), solid_from_image.translation().dot(v));
  PlaneField field{solid, height * normal, u, v, {}};
  if (window_px) {
    field.window.emplace(origin + scale.cwiseProduct(window_px->min()), origin + scale.cwiseProduct(window_px->max()));
  }
  // A little larger, and not by a round number, so that nothing symmetric falls on grid points.
  const double half_side_mm = solid.radius_mm() * 1.0173;

  std::vector<Polygon> outlines;
  for (const Polygon& line : Marcher(field, half_side_mm).lines()) {
    Polygon outline = thinned(refined(field, line), kThinning);
    if (outline.size() < 3) continue;
    for (Eigen::Vector2d& point : outline) point = (point - origin).cwiseQuotient(scale);
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

}  // namespace

std::vector<Polygon> section_outlines(const Solid& solid, const Eigen::Affine3d& solid_from_image) {
  return outlines_within(solid, solid_from_image, {});
}

std::vector<Contour> image_outlines(const Solid& solid, const Eigen::Affine3d& solid_from_image, cv::Size size) {
  const Eigen::AlignedBox2d window(Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(size.width - 0.5, size.height - 0.5));
  std::vector<Contour> contours;
  for (Polygon& outline : outlines_within(solid, solid_from_image, window)) {
    contours.push_back(opened_at_border(std::move(outline), window));
  }
  return contours;
}

}  // namespace fathom
