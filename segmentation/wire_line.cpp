#include "segmentation/wire_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "segmentation/least_bent.h"

namespace fathom {

namespace {

constexpr double kClose_px = 1.5;        // the path between a seed and its edge is no part of the outline
constexpr double kSpacing_px = 2.0;      // of the line's points
constexpr std::size_t kNeighbours = 10;  // points of the lines before and behind that say how this one begins and ends
constexpr std::size_t kBendOver = 6;     // points to either side

// Rounds of going to the edge: the first stays near the path, which later ones smooth away where it follows speckle.
// All by the scale of the edges s. With the weight of a clear edge, bends shorter than about (stiffness)^(1/6) are
// evened out: 1.6 s, then 6.6 s.
struct Round {
  double reach;      // s; farther is another edge
  double stiffness;  // s^6
};
constexpr std::array<Round, 4> kRounds = {{{0.8, 20.0}, {2.4, 8e4}, {2.4, 8e4}, {2.4, 8e4}}};

// Smoothing moves the steepest place of a bent edge towards the inside of the bend, by v / (2 R) at a radius R. Of
// the mean of Gaussians of s, 2 s and 4 s, each divided by its noise (so that the steepest values go as s), v is
// (s + 2 s + 4 s) / (1 / s + 1 / (2 s) + 1 / (4 s)).
constexpr double kSmoothedBy = 4.0;      // s^2
constexpr double kMostSmoothedBy = 0.5;  // s, either way
constexpr double kUnseen = 1e-6;         // weight of points without an edge, against 1 for a clear one
constexpr double kSeed = 1e6;            // a seed stays
constexpr double kDirectionOver_px = 5.0;

// Points at equal distances of about `kSpacing_px`; the ends stay.
Polygon evenly_spaced(const Polygon& line) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  const auto count = static_cast<std::size_t>(std::max(2.0, std::round(length / kSpacing_px)));
  const double step = length / static_cast<double>(count);
  Polygon even = {line.front()};
  double left = step;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d edge = line[i + 1] - line[i];
    const double piece = edge.norm();
    for (; left <= piece && even.size() < count; left += step) even.push_back(line[i] + left / piece * edge);
    left -= piece;
  }
  even.push_back(line.back());
  return even;
}

// How a line is held against edges.
struct Fit {
  const EdgeMap& map;
  const EdgePreference& preference;
  double beside_px;  // to the right of an edge is where the line belongs
};

// Where a point between the ends should be for the edge beside it, and how clear that is. `from_px`: where edges are
// looked for, to the left of the line.
WantedPoint on_edge(const Fit& fit, const Polygon& line, std::size_t i, double from_px, double reach_px) {
  const Eigen::Vector2d along = direction_at(line, i);
  const Eigen::Vector2d side = right_of(along);
  const Eigen::Vector2d start = line[i] - from_px * side;
  const EdgePeak peak = edge_peak(fit.map, fit.preference, start, along, reach_px);
  if (!(peak.strength > 0.0)) return {start + fit.beside_px * side, kUnseen};
  const double outwards = -smoothed_aside_px(fit.map, line, i);
  const double clear = fit.preference.fit(fit.preference.bright_side < 0 ? -peak.strength : peak.strength);
  return {start + (peak.offset_px + outwards + fit.beside_px) * side, std::max(clear, kUnseen)};
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

double smoothed_aside_px(const EdgeMap& map, std::span<const Eigen::Vector2d> line, std::size_t index) {
  const std::size_t reach = std::min(kBendOver, (line.size() - 1) / 2);
  if (reach == 0) return 0.0;
  const std::size_t at = std::clamp(index, reach, line.size() - 1 - reach);
  const Eigen::Vector2d before = line[at] - line[at - reach];
  const Eigen::Vector2d behind = line[at + reach] - line[at];
  const double turn = std::atan2(before.x() * behind.y() - before.y() * behind.x(), before.dot(behind));
  const double length = 0.5 * (before.norm() + behind.norm());
  if (!(length > 0.0)) return 0.0;
  const double scale = map.scale_px;
  return std::clamp(0.5 * kSmoothedBy * scale * scale * turn / length, -kMostSmoothedBy * scale,
                    kMostSmoothedBy * scale);
}

Polygon wire_line(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> path,
                  double spacing_px, const WireEnds& ends) {
  const Fit fit{map, preference, preference.bright_side * preference.beside_px};
  const double apart = std::abs(fit.beside_px) + kClose_px;
  Polygon line = {ends.from};
  for (const Eigen::Vector2d& point : path) {
    if ((point - ends.from).norm() > apart && (point - ends.to).norm() > apart) line.push_back(point);
  }
  line.push_back(ends.to);
  // Evenly spaced as well, for it says how the lines beside it begin and end.
  if (line.size() < 4) return ends.from == ends.to ? Polygon{ends.from, ends.to} : evenly_spaced({ends.from, ends.to});
  const auto before = ends.before.last(std::min(ends.before.size(), kNeighbours));
  const auto behind = ends.behind.first(std::min(ends.behind.size(), kNeighbours));
  for (const Round& round : kRounds) {
    line = evenly_spaced(line);
    std::vector<WantedPoint> wanted;
    for (const Eigen::Vector2d& point : before) wanted.push_back({point, 1.0});
    wanted.push_back({ends.from, kSeed});
    // On the inside of bends a coarse path is farther off than the reach.
    const double reach = std::max(round.reach * map.scale_px, spacing_px);
    const double from = &round == kRounds.begin() ? 0.0 : fit.beside_px;  // the path is on the edge itself
    for (std::size_t i = 1; i + 1 < line.size(); ++i) wanted.push_back(on_edge(fit, line, i, from, reach));
    wanted.push_back({ends.to, kSeed});
    for (const Eigen::Vector2d& point : behind) wanted.push_back({point, 1.0});
    const Polygon made = least_bent(wanted, round.stiffness * std::pow(map.scale_px / kSpacing_px, 6));
    line.assign(made.begin() + std::ssize(before), made.end() - std::ssize(behind));
  }
  line.front() = ends.from;
  line.back() = ends.to;
  return line;
}

}  // namespace fathom
