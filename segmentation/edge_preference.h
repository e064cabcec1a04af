#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "segmentation/edge_map.h"

namespace fathom {

/// What kind of edge an outline follows: learnt from the part that is drawn, and then preferred. Sides are those of
/// somebody who walks along the line, as it is seen on the screen (y runs down).
struct EdgePreference {
  int bright_side = 0;       ///< 1: the right is brighter, -1: the left is; 0: either may be
  double strength = 3.0;     ///< of typical edges, in standard deviations of noise
  bool stronger_too = true;  ///< edges much stronger than that are as good; else they are worse, as weaker ones are
  /// How far the outline lies from where the grey values change most, in pixels: positive towards the bright side. Who
  /// draws along the middle of a bright wall draws beside its edges.
  double beside_px = 0.0;

  /// An edge of that strength across the line, positive where the right is brighter, as far as its sides are right.
  double on_right_side(double across) const { return bright_side == 0 ? std::abs(across) : bright_side * across; }
  /// How well it fits: 0 to 1.
  double fit(double across) const;
};

/// The direction to the right of a line that walks in direction `along`, a unit vector.
inline Eigen::Vector2d right_of(const Eigen::Vector2d& along) { return {-along.y(), along.x()}; }

/// The gradient across a line that walks in direction `along` (a unit vector): positive where the right is brighter.
inline double across_line(const Eigen::Vector2d& gradient, const Eigen::Vector2d& along) {
  return along.x() * gradient.y() - along.y() * gradient.x();
}

/// Where across a line, within `reach_px` to its right (positive) or left, an edge is strongest, and how strong:
/// distances count little against strength.
struct EdgePeak {
  double offset_px = 0.0;
  double strength = 0.0;  ///< on its right side; not positive where there is none
};
EdgePeak edge_peak(const EdgeMap& map, const EdgePreference& preference, const Eigen::Vector2d& point,
                   const Eigen::Vector2d& along, double reach_px);

inline constexpr std::size_t kLeastTrainingPoints = 12;
inline constexpr double kTrainingReach_px = 4.0;  ///< how far from a line its edge may lie

/// What the edges within `reach_px` of a line show. Lines of fewer than `kLeastTrainingPoints` teach nothing: the
/// preference that accepts all edges is returned. `beside_px` stays 0.
EdgePreference learn_edges(const EdgeMap& map, std::span<const Eigen::Vector2d> line, bool closed,
                           double reach_px = kTrainingReach_px);

/// What several lines show together: the side that most of them agree on, the middle of their strengths, the mean of
/// their places. Those that taught nothing do not count.
EdgePreference together(std::span<const EdgePreference> learnt);

/// `beside_px` from places that were chosen with care, such as seeds; `along` are the line's directions there. Few say
/// less than many.
double learn_place(const EdgeMap& map, const EdgePreference& preference, std::span<const Eigen::Vector2d> places,
                   std::span<const Eigen::Vector2d> along);

}  // namespace fathom
