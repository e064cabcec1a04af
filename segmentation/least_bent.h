#pragma once

#include <span>

#include "segmentation/contours.h"

namespace fathom {

/// Where a point of a line is wanted, and how much.
struct WantedPoint {
  Eigen::Vector2d place_px = Eigen::Vector2d::Zero();
  double weight = 0.0;
};

/// The open line of as many points x that makes the sum of weight |x - place|^2 and `stiffness` times its squared
/// third differences least: a smoothing spline, for points about evenly spaced. It changes its bend as little as it
/// can, so that arcs of circles stay, and goes on as an arc where points have no weight. The first and the last point
/// stay whatever their weights. Weights below 1e-11 of the stiffness count as that.
Polygon least_bent(std::span<const WantedPoint> wanted, double stiffness);

}  // namespace fathom
