#include "segmentation/edge_preference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/statistics.h"

namespace fathom {

namespace {

constexpr double kHalf = 0.4;        // of the typical strength: fits half
constexpr double kTooStrong = 1.75;  // of the typical strength: from here on edges belong to something else
constexpr double kOneSided = 0.5;    // of the signed over the unsigned mean: the bright side is known
constexpr double kLeastStrength = 4.0;
constexpr double kMostStrength = 30.0;
constexpr double kPeakStep_px = 0.5;
constexpr double kDistanceCounts = 0.3;  // what the strength counts less at the end of the reach
constexpr double kClear = 0.4;           // of the typical strength: the edge at a place is seen well enough
constexpr double kDoubt = 0.5;           // places that lie on the edge exactly, added to those that were seen

}  // namespace

double EdgePreference::fit(double across) const {
  double z = std::max(0.0, on_right_side(across));
  const double limit = kTooStrong * strength;
  if (!stronger_too && z > limit) z = limit * limit / z;
  const double share = z / (kHalf * strength);
  return share * share / (1.0 + share * share);
}

EdgePeak edge_peak(const EdgeMap& map, const EdgePreference& preference, const Eigen::Vector2d& point,
                   const Eigen::Vector2d& along, double reach_px) {
  const Eigen::Vector2d side = right_of(along);
  const auto strength = [&](double offset) {
    return preference.on_right_side(across_line(map.at(point + offset * side), along));
  };
  const int steps = static_cast<int>(std::floor(reach_px / kPeakStep_px));
  EdgePeak best;
  double best_value = -std::numeric_limits<double>::infinity();
  for (int i = -steps; i <= steps; ++i) {
    const double offset = i * kPeakStep_px;
    const double here = strength(offset);
    const double far = offset / (reach_px + kPeakStep_px);
    const double value = here * (1.0 - kDistanceCounts * far * far);
    if (value <= best_value) continue;
    best_value = value;
    best = {offset, here};
  }
  // Between the samples: the top of a parabola.
  const double before = strength(best.offset_px - kPeakStep_px);
  const double after = strength(best.offset_px + kPeakStep_px);
  const double bend = before - 2.0 * best.strength + after;
  if (bend < 0.0) best.offset_px += std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) * kPeakStep_px;
  return best;
}

EdgePreference learn_edges(const EdgeMap& map, std::span<const Eigen::Vector2d> line, bool closed, double reach_px) {
  const std::size_t count = line.size();
  EdgePreference learnt;
  if (count < kLeastTrainingPoints) return learnt;
  struct Place {
    Eigen::Vector2d point;
    Eigen::Vector2d along;
  };
  std::vector<Place> places;
  for (std::size_t i = closed ? 0 : 1; i < count - (closed ? 0 : 1); ++i) {
    // From one neighbour to the other, so that the steps of a path along pixels do not count for its direction.
    const Eigen::Vector2d along = line[(i + 1) % count] - line[(i + count - 1) % count];
    if (along.norm() > 0.0) places.push_back({line[i], along.normalized()});
  }
  // The bright side: by the strongest edges near the line, all of them.
  double sum = 0.0;
  double size = 0.0;
  for (const Place& place : places) {
    const Eigen::Vector2d side = right_of(place.along);
    for (double offset = -reach_px; offset <= reach_px; offset += 1.0) {
      const double across = across_line(map.at(place.point + offset * side), place.along);
      sum += across * std::abs(across);
      size += across * across;
    }
  }
  if (!(size > 0.0)) return learnt;
  if (std::abs(sum) > kOneSided * size) learnt.bright_side = sum > 0.0 ? 1 : -1;
  std::vector<double> strengths;
  for (const Place& place : places) {
    strengths.push_back(edge_peak(map, learnt, place.point, place.along, reach_px).strength);
  }
  learnt.strength = std::clamp(median(std::move(strengths)), kLeastStrength, kMostStrength);
  learnt.stronger_too = false;
  return learnt;
}

EdgePreference together(std::span<const EdgePreference> learnt) {
  EdgePreference all;
  std::vector<double> strengths;
  double place = 0.0;
  int sides = 0;
  for (const EdgePreference& one : learnt) {
    if (one.stronger_too) continue;
    strengths.push_back(one.strength);
    sides += one.bright_side;
    place += one.beside_px;
  }
  if (strengths.empty()) return all;
  const auto count = static_cast<double>(strengths.size());
  // Half of the lines at least.
  if (2.0 * std::abs(sides) >= count) all.bright_side = sides > 0 ? 1 : -1;
  if (all.bright_side != 0) all.beside_px = place / count;
  all.strength = median(std::move(strengths));
  all.stronger_too = false;
  return all;
}

double learn_place(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> places,
                   std::span<const Eigen::Vector2d> along) {
  if (preference.bright_side == 0) return 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const EdgePeak peak = edge_peak(map, preference, places[i], along[i], kTrainingReach_px);
    if (peak.strength < kClear * preference.strength) continue;
    sum -= preference.bright_side * peak.offset_px;
    count += 1.0;
  }
  return sum / (count + kDoubt);
}

}  // namespace fathom
