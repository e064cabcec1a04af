#include "viewer/assist_preview.h"

#include <algorithm>

#include "segmentation/edge_map.h"
#include "segmentation/outline_mask.h"
#include "segmentation/refine.h"
#include "segmentation/region_growing.h"
#include "segmentation/threshold.h"

namespace fathom {

namespace {

constexpr double kLeastPart_px = 50.0;  // area: what is smaller is hardly meant, and hard to click

bool lies_in(const Eigen::Vector2d& point_px, const Polygon& outline) {
  return encloses(std::span(&outline, 1), point_px);
}

std::vector<Polygon> region(const AssistInput& input) {
  if (input.seeds_px.empty()) return {};
  RegionOptions options;
  options.tolerance = static_cast<double>(input.options.tolerance);
  options.smoothing_px = static_cast<double>(input.options.even_out_px);
  return grow_region(input.image, input.seeds_px, options);
}

std::vector<Polygon> threshold(const AssistInput& input) {
  ThresholdOptions options;
  options.threshold = static_cast<double>(input.options.low);
  options.upper = static_cast<double>(input.options.high);
  options.smoothing_px = static_cast<double>(input.options.even_out_px);
  options.min_area_px = kLeastPart_px;
  const std::vector<Polygon> all = threshold_outlines(grey_values(input.image), options);
  return input.seeds_px.empty() ? all : parts_with_seeds(all, input.seeds_px);
}

std::vector<Polygon> refined(const AssistInput& input) {
  if (input.outlines.empty()) return {};
  RefineOptions options;
  options.reach_px = static_cast<double>(input.options.reach_px);
  const EdgeMap map = edge_map(input.image, options.edges);
  const std::vector<Polygon> outlines = structure_on_right(input.outlines);
  return refine_outlines(map, outlines, learn_boundary(map, outlines, options), options, input.beside);
}

}  // namespace

bool is_assist(Tool tool) { return tool == Tool::kRegion || tool == Tool::kThreshold || tool == Tool::kRefine; }

std::vector<Polygon> assist_preview(const AssistInput& input) {
  if (input.tool == Tool::kRegion) return region(input);
  return input.tool == Tool::kThreshold ? threshold(input) : refined(input);
}

std::vector<Polygon> parts_with_seeds(const std::vector<Polygon>& outlines,
                                      const std::vector<Eigen::Vector2d>& seeds_px) {
  // Outlines do not cross, so how many lie around one tells outer ones (even) from holes (odd).
  std::vector<int> depth(outlines.size(), 0);
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    for (std::size_t k = 0; k < outlines.size(); ++k) {
      if (k != i && lies_in(outlines[i].front(), outlines[k])) ++depth[i];
    }
  }
  std::vector<bool> kept(outlines.size(), false);
  for (const Eigen::Vector2d& seed : seeds_px) {
    std::size_t innermost = outlines.size();
    for (std::size_t i = 0; i < outlines.size(); ++i) {
      if (!lies_in(seed, outlines[i])) continue;
      if (innermost == outlines.size() || depth[i] > depth[innermost]) innermost = i;
    }
    if (innermost == outlines.size() || depth[innermost] % 2 != 0) continue;
    kept[innermost] = true;
    for (std::size_t i = 0; i < outlines.size(); ++i) {
      if (depth[i] == depth[innermost] + 1 && lies_in(outlines[i].front(), outlines[innermost])) kept[i] = true;
    }
  }
  std::vector<Polygon> parts;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    if (kept[i]) parts.push_back(outlines[i]);
  }
  return parts;
}

}  // namespace fathom
