#include "segmentation/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/error.h"
#include "segmentation/best_shifts.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_resampling.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

constexpr double kMostReach_px = 100.0;
constexpr double kMostStiffness = 100.0;
constexpr double kSpacing_px = 2.0;
constexpr int kLeastPoints = 16;  // even the smallest outline keeps its shape
constexpr double kStep_px = 0.5;  // between the shifts that are tried
constexpr double kStay = 0.25;    // what a shift by the whole reach costs, against 1 for an edge that fits
constexpr double kBend = 0.33;  // what a change of shift by the points' distance costs, by the cube of the edges' scale
constexpr double kOfFreeRoom = 0.9;                    // of the room up to the middle between two parts of the outlines
constexpr double kTouching_px = 0.5;                   // outlines of different structures so near to each other touch
constexpr double kBesideSpacing_px = 0.5;              // between the points that stand for other structures' outlines
constexpr std::array<double, 2> kShares = {1.0, 0.4};  // of the reach, in two rounds
constexpr int kFlank = 4;                              // steps to either side in which an edge must be the strongest
constexpr double kNoise = 1.5;                         // standard deviations: speckle alone makes edges so strong
constexpr int kTopOnly = 4;                            // power of its share of that
constexpr int kSmoothing = 2;

// What a line may not be moved into: the outlines of its own structure and those of others.
struct Surroundings {
  const std::vector<Polygon>& own;
  const std::vector<Polygon>& beside;
};

// How far a point may move to its right (side 1) or left (-1) before it comes to the middle between this place and
// another of the outlines: the smallest ball that touches the line here and has another point on it.
double free_room(const Surroundings& around, const Eigen::Vector2d& point, const Eigen::Vector2d& normal,
                 double reach_px) {
  double room = reach_px / kOfFreeRoom;
  const auto limit = [&](const std::vector<Polygon>& outlines, double touching_px) {
    for (const Polygon& outline : outlines) {
      for (const Eigen::Vector2d& other : outline) {
        const Eigen::Vector2d to = other - point;
        const double beside = to.dot(normal);
        if (to.squaredNorm() < touching_px * touching_px) room = 0.0;
        if (beside > 0.0) room = std::min(room, 0.5 * to.squaredNorm() / beside);
      }
    }
  };
  limit(around.own, 0.0);
  limit(around.beside, kTouching_px);
  return kOfFreeRoom * room;
}

// How strong the edge is that runs along the line through a place, on its right side.
double strength_at(const EdgeMap& map, const EdgePreference& boundary, const Eigen::Vector2d& place,
                   const Eigen::Vector2d& along) {
  const bool outside =
      place.minCoeff() < -0.5 || place.x() > map.gradient.cols - 0.5 || place.y() > map.gradient.rows - 0.5;
  return outside ? 0.0 : std::max(0.0, boundary.on_right_side(across_line(map.at(place), along)));
}

// What the edges say to each shift across the line: 0 on one that fits, 1 where there is none. The flank of an edge
// that is itself out of reach is none.
std::vector<double> misfits(const EdgeMap& map, const EdgePreference& boundary, const Eigen::Vector2d& start,
                            const Eigen::Vector2d& along, int steps) {
  std::vector<double> strengths;
  for (int step = -steps - kFlank; step <= steps + kFlank; ++step) {
    strengths.push_back(strength_at(map, boundary, start + step * kStep_px * right_of(along), along));
  }
  std::vector<double> all;
  for (auto here = strengths.begin() + kFlank; here != strengths.end() - kFlank; ++here) {
    const double highest = *std::max_element(here - kFlank, here + kFlank + 1);
    const double top = highest > 0.0 ? *here / highest : 0.0;
    const double clear = std::max(0.0, *here - kNoise);
    all.push_back(1.0 - boundary.fit(boundary.bright_side < 0 ? -clear : clear) * std::pow(top, kTopOnly));
  }
  return all;
}

// One round: every point of one outline shifted across it, not farther than the reach from where it was `drawn`.
Polygon moved(const EdgeMap& map, const Surroundings& around, const Polygon& outline, const Polygon& drawn,
              const EdgePreference& boundary, double reach_px, const RefineOptions& options) {
  const std::size_t count = outline.size();
  const int steps = static_cast<int>(std::floor(reach_px / kStep_px));
  if (steps == 0) return outline;
  const double beside = boundary.bright_side * boundary.beside_px;
  ShiftCosts costs(count, steps);
  Polygon sides;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d along = (outline[(i + 2) % count] - outline[(i + count - 2) % count]).normalized();
    const Eigen::Vector2d side = right_of(along);
    sides.push_back(side);
    const double right = free_room(around, outline[i], side, reach_px);
    const double left = free_room(around, outline[i], -side, reach_px);
    const std::vector<double> misfit = misfits(map, boundary, outline[i] - beside * side, along, steps);
    for (int step = -steps; step <= steps; ++step) {
      const double shift = step * kStep_px;
      if (shift > right || -shift > left) continue;
      const bool too_far = (outline[i] + shift * side - drawn[i]).norm() > options.reach_px;
      if (step != 0 && too_far) continue;
      const double far = shift / options.reach_px;
      costs.at(i, step) = misfit[static_cast<std::size_t>(step + steps)] + kStay * far * far;
    }
  }
  const double spacing = perimeter(outline) / static_cast<double>(count);
  const double bend = (0.02 + kBend * std::pow(map.scale_px, 3) * options.stiffness) * std::pow(kStep_px / spacing, 2);
  const std::vector<int> shifts = best_shifts(costs, bend);
  Polygon result = outline;
  for (std::size_t i = 0; i < count; ++i) result[i] += shifts[i] * kStep_px * sides[i];
  return smoothed(result, kSmoothing);
}

// As far towards `wanted` as the outlines stay simple.
std::vector<Polygon> as_far_as_simple(const std::vector<Polygon>& from, const std::vector<Polygon>& wanted) {
  for (double share = 1.0; share > 0.1; share *= 0.5) {
    std::vector<Polygon> tried = from;
    for (std::size_t k = 0; k < tried.size(); ++k) {
      for (std::size_t i = 0; i < tried[k].size(); ++i) tried[k][i] += share * (wanted[k][i] - from[k][i]);
    }
    if (!outline_fault(tried)) return tried;
  }
  return from;
}

}  // namespace

void RefineOptions::check() const {
  edges.check();
  if (!(reach_px > 0.0 && reach_px <= kMostReach_px)) throw Error("refine: the reach must be above 0, to 100 pixels");
  if (!(stiffness >= 0.0 && stiffness <= kMostStiffness)) throw Error("refine: the stiffness must be from 0 to 100");
}

std::vector<Polygon> structure_on_right(std::span<const Polygon> outlines) {
  std::vector<Polygon> turned(outlines.begin(), outlines.end());
  const std::vector<Nesting> places = nesting(turned);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = without_repeats(turned[i]);
    const bool clockwise = signed_area(turned[i]) > 0.0;
    if (clockwise == (places[i] == Nesting::kHole)) std::reverse(turned[i].begin(), turned[i].end());
  }
  return turned;
}

EdgePreference learn_boundary(const EdgeMap& map, std::span<const Polygon> outlines, const RefineOptions& options) {
  std::vector<EdgePreference> learnt;
  for (const Polygon& outline : structure_on_right(outlines)) {
    const Polygon line = resampled(outline, kSpacing_px, kLeastPoints);
    EdgePreference one = learn_edges(map, line, true, std::min(options.reach_px, 2.0 * kTrainingReach_px));
    if (options.keep_place) {
      Polygon along;
      for (std::size_t i = 0; i < line.size(); ++i) {
        along.push_back((line[(i + 1) % line.size()] - line[(i + line.size() - 1) % line.size()]).normalized());
      }
      one.beside_px = learn_place(map, one, line, along);
    }
    learnt.push_back(one);
  }
  return together(learnt);
}

std::vector<Polygon> refine_outlines(const EdgeMap& map, std::span<const Polygon> outlines,
                                     const EdgePreference& boundary, const RefineOptions& options,
                                     std::span<const Polygon> beside) {
  options.check();
  const std::vector<Polygon> drawn(outlines.begin(), outlines.end());
  if (map.flat || outline_fault(drawn)) return drawn;
  std::vector<Polygon> now;
  for (const Polygon& outline : structure_on_right(outlines)) {
    now.push_back(resampled(outline, kSpacing_px, kLeastPoints));
  }
  if (outline_fault(now)) return drawn;
  const std::vector<Polygon> start = now;
  std::vector<Polygon> others;
  for (const Polygon& other : beside) others.push_back(resampled(other, kBesideSpacing_px, kLeastPoints));
  for (const double share : kShares) {
    std::vector<Polygon> wanted;
    for (std::size_t k = 0; k < now.size(); ++k) {
      wanted.push_back(moved(map, {now, others}, now[k], start[k], boundary, share * options.reach_px, options));
    }
    now = as_far_as_simple(now, wanted);
  }
  return now;
}

}  // namespace fathom
