#pragma once

#include <span>
#include <string>

#include "exam/results_export.h"

namespace fathom {

/// The areas of a structure's cross-sections over the way along each sweep, as an SVG element for a page: a line for
/// each sweep with a mark for each section, both axes from zero. `color` is "#rrggbb" and fills the area below the line
/// where there is one sweep. Empty with fewer than two sections in every sweep, or areas that are all zero.
std::string area_graph_svg(std::span<const SectionRow> rows, const std::string& color);

}  // namespace fathom
