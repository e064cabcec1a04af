#include "segmentation/wire_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fathom {

namespace {

constexpr int kSmoothing = 4;        // passes of a quarter, half, quarter: takes away stairs, leaves bends of 4 points
constexpr int kRounds = 2;           // of going to the edge
constexpr double kLeastReach = 1.0;  // pixels that the line may leave the path by: farther is another edge
constexpr double kClose_px = 1.5;    // the path between a seed and its edge is no part of the outline
constexpr double kSpacing_px = 2.0;  // of the line's points
constexpr double kDirectionOver_px = 5.0;

// The ends stay.
void smooth(Polygon& line, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    Eigen::Vector2d before = line.front();
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      const Eigen::Vector2d here = line[i];
      line[i] = 0.25 * before + 0.5 * here + 0.25 * line[i + 1];
      before = here;
    }
  }
}

// Points at least `kSpacing_px` apart; the ends stay.
Polygon thinned(const Polygon& line) {
  Polygon kept = {line.front()};
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    if ((line[i] - kept.back()).norm() >= kSpacing_px && (line[i] - line.back()).norm() >= kSpacing_px) {
      kept.push_back(line[i]);
    }
  }
  kept.push_back(line.back());
  return kept;
}

/// Its points, moved by what `offset` says of each, in pixels to the right; the ends stay.
template <typename Offset>
Polygon shifted(const Polygon& line, const Offset& offset) {
  Polygon moved = line;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d along = line[i + 1] - line[i - 1];
    if (!(along.norm() > 0.0)) continue;
    const Eigen::Vector2d unit = along.normalized();
    moved[i] += offset(line[i], unit) * right_of(unit);
  }
  smooth(moved, kSmoothing);
  return moved;
}

}  // namespace

Eigen::Vector2d direction_at(std::span<const Eigen::Vector2d> line, std::size_t index) {
  const auto far = [&](int step) {
    std::size_t i = index;
    while ((step > 0 ? i + 1 < line.size() : i > 0) && (line[i] - line[index]).norm() < kDirectionOver_px) {
      i = step > 0 ? i + 1 : i - 1;
    }
    return line[i];
  };
  const Eigen::Vector2d along = far(1) - far(-1);
  return along.norm() > 0.0 ? Eigen::Vector2d(along.normalized()) : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

Polygon wire_line(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> path,
                  double spacing_px, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double beside = preference.bright_side * preference.beside_px;  // to the right
  const double apart = std::abs(beside) + kClose_px;
  Polygon line = {from};
  for (const Eigen::Vector2d& point : path) {
    if ((point - from).norm() > apart && (point - to).norm() > apart) line.push_back(point);
  }
  line.push_back(to);
  if (line.size() < 4) return {from, to};
  smooth(line, kSmoothing);
  // On the inside of bends the coarse path is farther off than the reach of one round; the first round shows the way.
  const double reach = std::max(kLeastReach, spacing_px);
  for (int round = 0; round < kRounds; ++round) {
    const double aside = round + 1 == kRounds ? beside : 0.0;
    line = shifted(line, [&](const Eigen::Vector2d& point, const Eigen::Vector2d& along) {
      const EdgePeak peak = edge_peak(map, preference, point, along, reach);
      return (peak.strength > 0.0 ? peak.offset_px : 0.0) + aside;
    });
  }
  return thinned(line);
}

}  // namespace fathom
