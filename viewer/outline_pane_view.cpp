#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <imgui.h>

#include "exam/scene_view.h"
#include "viewer/outline_pane.h"
#include "viewer/scene_lines.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr double kMargin = 1.15;  // around everything

}  // namespace

void OutlinePane::look_at_all(const Session& session) {
  const std::vector<Eigen::Vector3d> corners = all_corners(session);
  if (corners.empty()) return;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners) box.extend(corner);
  camera_.centre_mm = box.center();
  camera_.depth_mm = 4.0 * std::max(box.diagonal().norm(), 1.0);
  const Eigen::Vector3d depth = mean_image_depth(session);
  camera_.view_from_reference = Eigen::Quaterniond(scene_view(corners, depth));
  Eigen::Vector2d reach = Eigen::Vector2d::Constant(1e-3);
  for (const Eigen::Vector3d& corner : corners) {
    reach = reach.cwiseMax((camera_.view() * corner).head<2>().cwiseAbs());
  }
  const Eigen::Vector2d pane(std::max(size_.x, 10.0F), std::max(size_.y, 10.0F));
  camera_.mm_per_pixel = kMargin * (2.0 * reach).cwiseQuotient(pane).maxCoeff();
}

void OutlinePane::look_along(int axis) {
  // The other two axes lie across, the next one to the right.
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  rows(0, (axis + 1) % 3) = 1.0;
  rows(1, (axis + 2) % 3) = 1.0;
  rows(2, axis) = 1.0;
  camera_.view_from_reference = Eigen::Quaterniond(rows);
}

void OutlinePane::draw_axes(ImDrawList& list) const {
  constexpr std::array<ImU32, 3> kColors{IM_COL32(255, 90, 90, 255), IM_COL32(90, 220, 90, 255),
                                         IM_COL32(110, 150, 255, 255)};
  constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
  const float length = 1.8F * ui::em();
  const ImVec2 origin(low_.x + 2.4F * ui::em(), low_.y + size_.y - 2.4F * ui::em());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d way = camera_.view_from_reference * Eigen::Vector3d::Unit(axis);
    const ImVec2 tip(origin.x + length * static_cast<float>(way.x()), origin.y + length * static_cast<float>(way.y()));
    const auto i = static_cast<std::size_t>(axis);
    list.AddLine(origin, tip, kColors[i], 2.0F);
    list.AddText({tip.x + 2.0F, tip.y - 0.6F * ui::em()}, kColors[i], kNames[i]);
  }
}

void OutlinePane::draw_scale_bar(ImDrawList& list) const {
  // The longest of 1, 2, 5, 10, ... mm that takes no more than a quarter of the pane.
  const double widest_mm = 0.25 * static_cast<double>(size_.x) * camera_.mm_per_pixel;
  double length_mm = std::pow(10.0, std::floor(std::log10(widest_mm)));
  if (5.0 * length_mm <= widest_mm) {
    length_mm *= 5.0;
  } else if (2.0 * length_mm <= widest_mm) {
    length_mm *= 2.0;
  }
  const auto length = static_cast<float>(length_mm / camera_.mm_per_pixel);
  const ImVec2 right(low_.x + size_.x - ui::em(), low_.y + size_.y - ui::em());
  const ImVec2 left(right.x - length, right.y);
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  list.AddLine(left, right, color, 2.0F);
  for (const ImVec2& end : {left, right}) list.AddLine({end.x, end.y - 4.0F}, {end.x, end.y + 4.0F}, color, 2.0F);
  char text[32];
  std::snprintf(text, sizeof text, "%g mm", length_mm);
  list.AddText({left.x, left.y - 1.4F * ui::em()}, color, text);
}

}  // namespace fathom
