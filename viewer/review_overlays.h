#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <imgui.h>
#include <opencv2/core/types.hpp>

namespace fathom {

class Session;
struct ImagePlace;

/// Blackens all of a pane from `low` to `high` but a part of the image; all of it where there is none.
void cover_names(const std::optional<cv::Rect>& nameless_px, const ImagePlace& place, ImVec2 low, ImVec2 high,
                 ImDrawList& list);

/// Outlines, holes, extremities and marks of all structures on the shown frame; points of the active one where a tool
/// takes them.
void draw_outlines(const Session& session, const ImagePlace& place, ImDrawList& list);

/// The line being drawn, and the ruler with its text.
void draw_line_and_ruler(const Session& session, const ImagePlace& place, ImDrawList& list);

/// Parts of the shown frame that another sweep covers: convex polygons in pixels. Treece 2000, section 4.2.3.
std::vector<std::vector<Eigen::Vector2d>> hatched_parts(const Session& session);
void draw_hatched(const std::vector<Eigen::Vector2d>& polygon_px, const ImagePlace& place, ImDrawList& list);

}  // namespace fathom
