#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "segmentation/box_columns.h"
#include "segmentation/contours.h"

namespace fathom {

/// The straight pieces of several closed outlines, numbered along the outlines, one outline after the other. Points
/// that repeat the one before are left out.
class OutlineEdges {
 public:
  explicit OutlineEdges(std::span<const Polygon* const> outlines);

  std::size_t size() const { return points_.size(); }
  std::size_t outlines() const { return first_.size() - 1; }
  std::size_t first_of(std::size_t outline) const { return first_[outline]; }
  std::size_t end_of(std::size_t outline) const { return first_[outline + 1]; }
  std::size_t outline_of(std::size_t edge) const { return outline_[edge]; }
  std::size_t next(std::size_t edge) const {
    return edge + 1 == end_of(outline_[edge]) ? first_[outline_[edge]] : edge + 1;
  }
  std::size_t previous(std::size_t edge) const {
    return (edge == first_[outline_[edge]] ? end_of(outline_[edge]) : edge) - 1;
  }
  const Eigen::Vector2d& start(std::size_t edge) const { return points_[edge]; }
  const Eigen::Vector2d& end(std::size_t edge) const { return points_[next(edge)]; }

  /// The box around a run of edges, `end` excluded, that goes on in one sense along x and in one along y.
  Box box_of_run(std::size_t first_edge, std::size_t end_edge) const {
    const Eigen::Vector2d& a = start(first_edge);
    const Eigen::Vector2d& b = end(end_edge - 1);
    return {std::min(a.x(), b.x()), std::max(a.x(), b.x()), std::min(a.y(), b.y()), std::max(a.y(), b.y())};
  }

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<std::size_t> outline_;
  std::vector<std::size_t> first_;  ///< of each outline, and the end
};

}  // namespace fathom
