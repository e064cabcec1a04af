#include "sim/thin_polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace fathom {

namespace {

/// Marks the points of [first, last] (indices past the end wrap) that a polygon must keep to stay within the tolerance
/// (Douglas and Peucker).
void keep_between(const Polygon& line, std::size_t first, std::size_t last, double tolerance, std::vector<bool>& keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open = {{first, last}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const Eigen::Vector2d a = line[from];
    const Eigen::Vector2d chord = line[to % line.size()] - a;
    const double squared = chord.squaredNorm();
    double largest = -1.0;
    std::size_t farthest = from;
    for (std::size_t i = from + 1; i < to; ++i) {
      const Eigen::Vector2d offset = line[i] - a;
      const double along = squared > 0.0 ? std::clamp(offset.dot(chord) / squared, 0.0, 1.0) : 0.0;
      const double distance = (offset - along * chord).squaredNorm();
      if (distance > largest) {
        largest = distance;
        farthest = i;
      }
    }
    if (largest <= tolerance * tolerance) continue;
    keep[farthest] = true;
    open.emplace_back(from, farthest);
    open.emplace_back(farthest, to);
  }
}

}  // namespace

Polygon thinned(const Polygon& line, double tolerance_of_area) {
  double area = 0.0;
  double perimeter = 0.0;
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector2d a = line[i] - line[0];
    const Eigen::Vector2d b = line[(i + 1) % line.size()] - line[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2.0;
    perimeter += (b - a).norm();
    if (a.squaredNorm() > (line[farthest] - line[0]).squaredNorm()) farthest = i;
  }
  std::vector<bool> keep(line.size(), false);
  keep[0] = keep[farthest] = true;
  const double tolerance = tolerance_of_area * std::abs(area) / perimeter;
  keep_between(line, 0, farthest, tolerance, keep);
  keep_between(line, farthest, line.size(), tolerance, keep);
  Polygon result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (keep[i]) result.push_back(line[i]);
  }
  return result;
}

}  // namespace fathom
