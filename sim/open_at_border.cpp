#include "sim/open_at_border.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom {

namespace {

constexpr double kOnBorder_px = 1e-6;
constexpr std::size_t kFewestPoints = 3;  // of a contour
enum Side : std::size_t { kLeft, kTop, kRight, kBottom, kSides };

double from_side(const Eigen::Vector2d& point, const Eigen::AlignedBox2d& window, std::size_t side) {
  const std::array<double, kSides> distances = {point.x() - window.min().x(), point.y() - window.min().y(),
                                                window.max().x() - point.x(), window.max().y() - point.y()};
  return std::abs(distances[side]);
}

/// Points `first` to `first + edges` (numbers past the end wrap) lie on one side of the window.
struct BorderRun {
  std::size_t first = 0;
  std::size_t edges = 0;
  double length = 0.0;
};

BorderRun longest_run(const Polygon& outline, const Eigen::AlignedBox2d& window) {
  const std::size_t count = outline.size();
  BorderRun longest;
  for (std::size_t side = 0; side < kSides; ++side) {
    const auto on_side = [&](std::size_t i) { return from_side(outline[i % count], window, side) < kOnBorder_px; };
    for (std::size_t first = 0; first < count; ++first) {
      std::size_t edges = 0;
      while (edges + 1 < count && on_side(first + edges) && on_side(first + edges + 1)) ++edges;
      const double length = (outline[(first + edges) % count] - outline[first]).norm();
      if (length > longest.length) longest = {first, edges, length};
    }
  }
  return longest;
}

}  // namespace

Contour opened_at_border(Polygon outline, const Eigen::AlignedBox2d& window) {
  Contour contour;
  const BorderRun run = longest_run(outline, window);
  contour.closed = run.edges == 0 || outline.size() + 1 < run.edges + kFewestPoints;
  if (!contour.closed) {
    const auto start = static_cast<std::ptrdiff_t>((run.first + run.edges) % outline.size());
    std::rotate(outline.begin(), outline.begin() + start, outline.end());
    outline.resize(outline.size() + 1 - run.edges);
  }
  contour.points_px = std::move(outline);
  return contour;
}

}  // namespace fathom
