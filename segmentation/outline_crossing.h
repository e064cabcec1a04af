#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "segmentation/outline_edges.h"

namespace fathom {

/// Pixels. What lies nearer to a line than this lies on it; coordinates of up to a million pixels are ten times finer.
inline constexpr double kTouchPx = 1e-9;

/// On which side of the line through a and b the point lies: -1, 0 (on it) or 1.
int side_of_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point);

/// Whether a point of the line through a and b lies between them or on one of them.
bool between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point);

/// The place where outlines pass through each other on two edges that do not follow each other, if they do: between
/// their ends, at a corner on the other edge, or at a corner where both start. To touch is not to pass through, nor is
/// to run along each other.
std::optional<Eigen::Vector2d> crossing(const OutlineEdges& edges, std::size_t i, std::size_t j);

}  // namespace fathom
