#pragma once

#include <functional>
#include <span>
#include <vector>

#include "segmentation/contours.h"

namespace fathom {

/// Outlines whose points are no more than needed to stay within 0.05 pixels of these; all of them where fewer would
/// make outlines cross.
std::vector<Polygon> thinned(std::vector<Polygon> outlines);

/// Outlines that were `made` anew from `old` ones, dense points, where only a part was meant to change: everywhere else
/// (`unchanged` of a point) they get the old outlines' own points back, so that repeated editing does not wear them
/// away. The rest is thinned.
std::vector<Polygon> with_old_parts(const std::vector<Polygon>& made, std::span<const Polygon> old,
                                    const std::function<bool(const Eigen::Vector2d&)>& unchanged);

}  // namespace fathom
