#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"
#include "viewer/view_state.h"

namespace fathom {

/// Whether the tool shows outlines that are found in the image: Region, Threshold, Refine.
bool is_assist(Tool tool);

/// What such a tool works on.
struct AssistInput {
  Tool tool = Tool::kRegion;
  cv::Mat image;  ///< as recorded
  AssistOptions options;
  /// Where the user clicked. Region: places inside; Threshold: parts to take, none: all of them.
  std::vector<Eigen::Vector2d> seeds_px;
  std::vector<Polygon> outlines;  ///< closed ones of the structure on the frame: what Refine moves
  std::vector<Polygon> beside;    ///< those of other structures there, which it does not move beyond
};

/// The closed outlines that the tool would draw. Throws Error as grow_region, threshold_outlines and refine_outlines.
std::vector<Polygon> assist_preview(const AssistInput& input);

/// Of outlines that do not cross, the parts (with their holes) in which seeds lie.
std::vector<Polygon> parts_with_seeds(const std::vector<Polygon>& outlines,
                                      const std::vector<Eigen::Vector2d>& seeds_px);

}  // namespace fathom
