#include "segmentation/outline_edges.h"

namespace fathom {

OutlineEdges::OutlineEdges(std::span<const Polygon* const> outlines) {
  std::size_t count = 0;
  for (const Polygon* outline : outlines) count += outline->size();
  points_.reserve(count);
  outline_.reserve(count);
  first_.reserve(outlines.size() + 1);
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    first_.push_back(points_.size());
    for (const Eigen::Vector2d& point : *outlines[i]) {
      if (points_.size() == first_.back() || points_.back() != point) points_.push_back(point);
    }
    while (points_.size() > first_.back() + 1 && points_.back() == points_[first_.back()]) points_.pop_back();
    outline_.resize(points_.size(), i);
  }
  first_.push_back(points_.size());
}

}  // namespace fathom
