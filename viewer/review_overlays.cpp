#include "viewer/review_overlays.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <imgui.h>

#include "core/error.h"
#include "measurement/propagate.h"
#include "viewer/look.h"
#include "viewer/review_pane.h"
#include "viewer/review_tools.h"
#include "viewer/session.h"

namespace fathom {

namespace {

constexpr ImU32 kNotYet = IM_COL32(255, 255, 255, 230);  // what is being drawn
constexpr float kDash = 6.0F;                            // of lines that are unsure, and the gap
constexpr float kHatchStep = 9.0F;                       // window's pixels between hatching lines

std::vector<ImVec2> in_window(const std::vector<Eigen::Vector2d>& points_px, const ImagePlace& place) {
  std::vector<ImVec2> points;
  points.reserve(points_px.size());
  for (const Eigen::Vector2d& point : points_px) points.push_back(place.at(point));
  return points;
}

void draw_points(const std::vector<ImVec2>& points, ImU32 color, std::optional<std::size_t> chosen, ImDrawList& list) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_chosen = chosen && *chosen == i;
    const float half = is_chosen ? 4.5F : 2.5F;
    const ImVec2 low(points[i].x - half, points[i].y - half);
    const ImVec2 high(points[i].x + half, points[i].y + half);
    list.AddRectFilled(low, high, is_chosen ? IM_COL32(255, 255, 255, 255) : color);
  }
}

bool is_unsure(const Contour& contour) { return contour.confidence && *contour.confidence < kSureContour; }

void draw_dashed(const std::vector<ImVec2>& points, bool closed, ImU32 color, float width, ImDrawList& list) {
  float way = 0.0F;  // since the last dash or gap began
  bool on = true;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) {
    ImVec2 from = points[i];
    const ImVec2 to = points[(i + 1) % points.size()];
    for (float left = std::hypot(to.x - from.x, to.y - from.y); left > 0.0F;) {
      const float step = std::min(left, kDash - way);
      const ImVec2 next(from.x + (to.x - from.x) * step / left, from.y + (to.y - from.y) * step / left);
      if (on) list.AddLine(from, next, color, width);
      from = next;
      left -= step;
      way += step;
      if (way < kDash) continue;
      way = 0.0F;
      on = !on;
    }
  }
}

// Dashed, with its confidence, where it was filled in and may be wrong.
void draw_contour(const Contour& contour, const std::vector<ImVec2>& points, ImU32 color, float width,
                  ImDrawList& list) {
  if (!is_unsure(contour)) {
    list.AddPolyline(points.data(), static_cast<int>(points.size()), color, contour.closed ? ImDrawFlags_Closed : 0,
                     width);
    return;
  }
  draw_dashed(points, contour.closed, color, width, list);
  char text[32];
  std::snprintf(text, sizeof text, "unsure: %.0f %%", 100.0 * *contour.confidence);
  list.AddText({points.front().x + 6.0F, points.front().y - 0.5F * ImGui::GetFontSize()}, color, text);
}

// White, as every line that is not yet in the exam.
void draw_preview(const ViewState& view, const ImagePlace& place, ImDrawList& list) {
  for (const std::vector<Eigen::Vector2d>& outline : view.preview_px) {
    const std::vector<ImVec2> points = in_window(outline, place);
    list.AddPolyline(points.data(), static_cast<int>(points.size()), kNotYet, ImDrawFlags_Closed, 2.0F);
  }
  for (const Eigen::Vector2d& seed : view.seeds_px) {
    list.AddCircleFilled(place.at(seed), 4.0F, kNotYet);
    list.AddCircle(place.at(seed), 5.0F, IM_COL32(0, 0, 0, 255));
  }
}

void draw_contours(const Session& session, std::size_t index, const ImagePlace& place, ImDrawList& list) {
  const Structure& structure = session.document()->structures()[index];
  const bool active = session.active_structure() == index;
  const ViewState& view = session.view;
  const ImU32 color = packed_color(structure.color.c_str(), active ? 1.0F : 0.6F);
  for (std::size_t i = 0; i < structure.contours.size(); ++i) {
    const Contour& contour = structure.contours[i];
    if (contour.frame != view.frame || contour.recording != view.recording) continue;
    const std::vector<ImVec2> points = in_window(contour.points_px, place);
    draw_contour(contour, points, color, active ? 2.0F : 1.5F, list);
    if (!active || view.tool != Tool::kPoints) continue;
    const bool has_chosen = view.chosen && view.chosen->contour == i;
    draw_points(points, color, has_chosen ? std::optional(view.chosen->point) : std::nullopt, list);
  }
  for (const Extremity& extremity : structure.extremities) {
    if (extremity.frame != view.frame || extremity.recording != view.recording) continue;
    const ImVec2 at = place.at(extremity.point_px);
    list.AddCircle(at, 6.0F, color, 24, 2.0F);
    list.AddLine({at.x - 10.0F, at.y}, {at.x + 10.0F, at.y}, color, 1.5F);
    list.AddLine({at.x, at.y - 10.0F}, {at.x, at.y + 10.0F}, color, 1.5F);
  }
}

// The part of a straight line inside of a convex polygon; empty where it passes by.
std::optional<std::pair<float, float>> inside(const std::vector<ImVec2>& polygon, ImVec2 from, ImVec2 way) {
  float low = -1e9F;
  float high = 1e9F;
  double twice_area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ImVec2 a = polygon[i];
    const ImVec2 b = polygon[(i + 1) % polygon.size()];
    twice_area += static_cast<double>(a.x * b.y - a.y * b.x);
  }
  const float sign = twice_area > 0.0 ? 1.0F : -1.0F;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ImVec2 a = polygon[i];
    const ImVec2 b = polygon[(i + 1) % polygon.size()];
    const ImVec2 inward(-sign * (b.y - a.y), sign * (b.x - a.x));
    const float distance = inward.x * (from.x - a.x) + inward.y * (from.y - a.y);
    const float speed = inward.x * way.x + inward.y * way.y;
    if (std::abs(speed) < 1e-6F) {
      if (distance < 0.0F) return std::nullopt;
    } else if (speed > 0.0F) {
      low = std::max(low, -distance / speed);
    } else {
      high = std::min(high, -distance / speed);
    }
  }
  if (low >= high) return std::nullopt;
  return std::pair(low, high);
}

}  // namespace

void draw_outlines(const Session& session, const ImagePlace& place, ImDrawList& list) {
  const std::vector<Structure>& structures = session.document()->structures();
  float y = 4.0F;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    draw_contours(session, i, place, list);
    const bool absent =
        std::any_of(structures[i].absent.begin(), structures[i].absent.end(), [&](const AbsentMark& mark) {
          return mark.frame == session.view.frame && mark.recording == session.view.recording;
        });
    if (!absent) continue;
    const std::string text = structures[i].name + ": absent here";
    const ImVec2 corner = list.GetClipRectMin();
    list.AddText({corner.x + 8.0F, corner.y + y + ImGui::GetFontSize() * 1.4F},
                 packed_color(structures[i].color.c_str()), text.c_str());
    y += ImGui::GetFontSize() * 1.2F;
  }
}

void draw_line_and_ruler(const Session& session, const ImagePlace& place, ImDrawList& list) {
  const ViewState& view = session.view;
  draw_preview(view, place, list);
  if (!view.line_px.empty()) {
    const std::vector<ImVec2> points = in_window(view.line_px, place);
    list.AddPolyline(points.data(), static_cast<int>(points.size()), kNotYet, 0, 1.5F);
    list.AddCircleFilled(points.front(), 4.0F, kNotYet);
    if (view.line_px.size() < 60) draw_points(points, kNotYet, std::nullopt, list);
  }
  if (!view.ruler_px.empty()) {
    const std::vector<ImVec2> points = in_window(view.ruler_px, place);
    const ImU32 color = IM_COL32(255, 235, 60, 255);
    const bool closed = view.tool == Tool::kArea && points.size() > 2;
    list.AddPolyline(points.data(), static_cast<int>(points.size()), color, closed ? ImDrawFlags_Closed : 0, 1.5F);
    draw_points(points, color, std::nullopt, list);
    list.AddText({points.back().x + 8.0F, points.back().y + 4.0F}, color, ruler_text(session).c_str());
  }
}

std::vector<std::vector<Eigen::Vector2d>> hatched_parts(const Session& session) {
  const Document& document = *session.document();
  const auto placed = session.reference_from_image();
  if (!placed) return {};
  try {
    const std::optional<Division>& division = document.division();
    if (!division || division->partition.planes().empty()) return {};
    for (std::size_t s = 0; s < division->sweeps.size(); ++s) {
      const Sweep& sweep = division->sweeps[s];
      if (sweep.recording != static_cast<std::size_t>(session.view.recording)) continue;
      if (!contains(sweep, session.view.frame)) continue;
      return division->partition.hatched(s, *placed, session.header()->width, session.header()->height);
    }
  } catch (const Error&) {
    // Said where the volume is.
  }
  return {};
}

void draw_hatched(const std::vector<Eigen::Vector2d>& polygon_px, const ImagePlace& place, ImDrawList& list) {
  if (polygon_px.size() < 3) return;
  const std::vector<ImVec2> polygon = in_window(polygon_px, place);
  ImVec2 low = polygon.front();
  ImVec2 high = polygon.front();
  for (const ImVec2& point : polygon) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  const ImU32 color = IM_COL32(255, 160, 40, 120);
  // Lines x + y = sum, the same in neighbouring polygons.
  const float first = std::ceil((low.x + low.y) / kHatchStep) * kHatchStep;
  for (float sum = first; sum < high.x + high.y; sum += kHatchStep) {
    const auto part = inside(polygon, {sum, 0.0F}, {-1.0F, 1.0F});
    if (!part) continue;
    list.AddLine({sum - part->first, part->first}, {sum - part->second, part->second}, color);
  }
}

void cover_names(const std::optional<cv::Rect>& nameless_px, const ImagePlace& place, ImVec2 low, ImVec2 high,
                 ImDrawList& list) {
  constexpr ImU32 kBlack = IM_COL32(0, 0, 0, 255);
  if (!nameless_px) return list.AddRectFilled(low, high, kBlack);
  // From the middles of its outer pixels, which pixels farther out do not shine into.
  const cv::Rect& part = *nameless_px;
  const Eigen::Vector2d first = place.to_window({part.x, part.y});
  const Eigen::Vector2d last = place.to_window({part.x + part.width - 1, part.y + part.height - 1});
  const auto left = static_cast<float>(std::ceil(first.x()));
  const auto top = static_cast<float>(std::ceil(first.y()));
  const auto right = static_cast<float>(std::floor(last.x()));
  const auto bottom = static_cast<float>(std::floor(last.y()));
  list.AddRectFilled(low, {left, high.y}, kBlack);
  list.AddRectFilled({right, low.y}, high, kBlack);
  list.AddRectFilled(low, {high.x, top}, kBlack);
  list.AddRectFilled({low.x, bottom}, high, kBlack);
}

}  // namespace fathom
