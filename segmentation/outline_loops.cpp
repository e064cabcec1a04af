#include "segmentation/outline_loops.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "segmentation/outline_crossing.h"

namespace fathom {

namespace {

struct Crossing {
  std::size_t first = 0;  // edges, in the numbers of the outline's points
  std::size_t second = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
};

std::optional<Crossing> first_crossing(const Polygon& outline) {
  const std::vector<const Polygon*> one = {&outline};
  const OutlineEdges edges(one);
  const auto box = [&](std::size_t edge) { return edges.box_of_run(edge, edge + 1); };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Box here = box(i);
    for (std::size_t j = i + 2; j < edges.size(); ++j) {
      if (edges.next(j) == i || !overlap(here, box(j))) continue;
      if (const auto place = crossing(edges, i, j)) return Crossing{i, j, *place};
    }
  }
  return std::nullopt;
}

}  // namespace

Polygon without_repeats(const Polygon& outline) {
  Polygon kept;
  for (const Eigen::Vector2d& point : outline) {
    if (kept.empty() || kept.back() != point) kept.push_back(point);
  }
  while (kept.size() > 1 && kept.back() == kept.front()) kept.pop_back();
  return kept;
}

double signed_area(const Polygon& outline) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i] - outline.front();
    const Eigen::Vector2d b = outline[(i + 1) % outline.size()] - outline.front();
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

Polygon without_loops(Polygon outline) {
  outline = without_repeats(outline);
  while (outline.size() > 3) {
    const auto found = first_crossing(outline);
    if (!found) break;
    const auto begin = outline.begin();
    const auto first = begin + static_cast<std::ptrdiff_t>(found->first) + 1;
    const auto second = begin + static_cast<std::ptrdiff_t>(found->second) + 1;
    Polygon loop(first, second);
    loop.push_back(found->place);
    Polygon rest(begin, first);
    rest.push_back(found->place);
    rest.insert(rest.end(), second, outline.end());
    Polygon& larger = std::abs(signed_area(loop)) > std::abs(signed_area(rest)) ? loop : rest;
    Polygon next = without_repeats(larger);
    // Each step drops a point at least, whatever rounding makes of the place.
    if (next.size() >= outline.size()) break;
    outline = std::move(next);
  }
  return outline;
}

}  // namespace fathom
