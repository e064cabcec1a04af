#include "viewer/reslice_pane.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr std::array<ImU32, ResliceViews::kCount> kColors{IM_COL32(90, 220, 120, 255), IM_COL32(230, 110, 230, 255)};

Eigen::Vector3d turned(const Eigen::Vector3d& vector, double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis) * vector;
}

// A place that can be dragged. True while it is, and the mouse moves.
bool drag_place(const std::string& name, ImVec2 at, float half, ImU32 color, ImDrawList& list) {
  ImGui::SetCursorScreenPos({at.x - half, at.y - half});
  ImGui::InvisibleButton(name.c_str(), {2.0F * half, 2.0F * half});
  ui::note_last(name);
  const bool lit = ImGui::IsItemHovered() || ImGui::IsItemActive();
  list.AddCircleFilled(at, lit ? half : 0.7F * half, color);
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  return ImGui::IsItemActive() && (moved.x != 0.0F || moved.y != 0.0F);
}

}  // namespace

void ReslicePane::draw(Session& session) {
  const Document* document = session.document();
  if (document == nullptr) return;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::GetContentRegionAvail();
  if (size.x < 20.0F || size.y < 20.0F) return;
  ui::note("pane:Reslice", low, {low.x + size.x, low.y + size.y});
  if (!document->is_calibrated()) {
    ImGui::TextWrapped("No calibration: no planes through space.");
    return;
  }
  views_.update(*document, session.view.recording, session.worker());
  const bool beside = size.x > size.y;
  const float half = std::floor(0.5F * (beside ? size.x : size.y)) - 1.0F;
  for (std::size_t i = 0; i < ResliceViews::kCount; ++i) {
    const float shift = i == 0 ? 0.0F : half + 2.0F;
    draw_view(session, i, beside ? ImVec2(low.x + shift, low.y) : ImVec2(low.x, low.y + shift),
              beside ? ImVec2(half, size.y) : ImVec2(size.x, half));
  }
}

void ReslicePane::draw_view(Session& session, std::size_t index, ImVec2 low, ImVec2 size) {
  const ResliceViews::View& view = views_.view(index);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 high(low.x + size.x, low.y + size.y);
  ui::note("pane:Reslice " + std::to_string(index + 1), low, high);
  list.PushClipRect(low, high, true);
  list.AddRectFilled(low, high, IM_COL32(0, 0, 0, 255));
  if (!view.error.empty()) {
    ImGui::SetCursorScreenPos(low);
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + size.x);
    ImGui::TextWrapped("%s", session.text_to_show(view.error).c_str());
    ImGui::PopTextWrapPos();
    list.PopClipRect();
    return;
  }
  if (view.number != uploaded_[index] && !view.rgba.empty()) {
    textures_[index].upload(view.rgba);
    uploaded_[index] = view.number;
  }
  Place place;
  place.middle = {0.5F * (low.x + high.x), 0.5F * (low.y + high.y)};
  place.scale =
      std::min(static_cast<double>(size.x) / view.plane.width_mm, static_cast<double>(size.y) / view.plane.height_mm);
  const Eigen::Vector2d half_mm(0.5 * view.plane.width_mm, 0.5 * view.plane.height_mm);
  if (uploaded_[index] != 0 && uploaded_[index] == view.number) {
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(textures_[index].id())), place.at(-half_mm),
                  place.at(half_mm));
  }
  // Letters burned into images lie anywhere in a plane through them.
  if (session.view.hides_names) list.AddRectFilled(low, high, IM_COL32(0, 0, 0, 255));
  list.AddRect(place.at(-half_mm), place.at(half_mm), kColors[index], 0.0F, 0, 1.5F);
  if (const auto placed = session.reference_from_image()) {
    const auto line = crossing(view.plane, frame_normal(*placed), placed->translation());
    if (line) list.AddLine(place.at((*line)[0]), place.at((*line)[1]), IM_COL32(255, 235, 60, 160));
  }
  draw_handles(index, place, list);
  list.PopClipRect();
}

void ReslicePane::draw_handles(std::size_t index, const Place& place, ImDrawList& list) {
  const std::size_t other = 1 - index;
  const CutPlane& plane = views_.view(index).plane;
  CutPlane moved = views_.view(other).plane;
  const auto line = crossing(plane, moved.normal(), moved.centre_mm);
  if (!line) return;
  const ImU32 color = kColors[other];
  list.AddLine(place.at((*line)[0]), place.at((*line)[1]), color, 1.5F);
  const float half = 0.5F * ui::em();
  const std::string name = "cut " + std::to_string(index + 1);
  const ImVec2 delta = ImGui::GetIO().MouseDelta;
  const Eigen::Vector2d middle = 0.5 * ((*line)[0] + (*line)[1]);
  if (drag_place(name + " move", place.at(middle), half, color, list)) {
    const Eigen::Vector3d way =
        (static_cast<double>(delta.x) * plane.right + static_cast<double>(delta.y) * plane.down) / place.scale;
    moved.centre_mm += way.dot(moved.normal()) * moved.normal();
    views_.move(other, moved);
  }
  // Turns the other plane about this one's normal, so that its end follows the mouse.
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (std::size_t end = 0; end < 2; ++end) {
    const Eigen::Vector2d at = middle + 0.85 * ((*line)[end] - middle);
    if (!drag_place(name + (end == 0 ? " turn first" : " turn last"), place.at(at), 0.7F * half, color, list)) continue;
    const Eigen::Vector2d to =
        Eigen::Vector2d(mouse.x - place.middle.x, mouse.y - place.middle.y) / place.scale - middle;
    const Eigen::Vector2d from = at - middle;
    if (to.norm() < 1e-6 || from.norm() < 1e-6) continue;
    const double angle = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    const Eigen::Vector3d pivot = plane.at(middle.x(), middle.y());
    moved.centre_mm = pivot + turned(moved.centre_mm - pivot, angle, plane.normal());
    moved.right = turned(moved.right, angle, plane.normal()).normalized();
    moved.down = turned(moved.down, angle, plane.normal());
    moved.down = (moved.down - moved.down.dot(moved.right) * moved.right).normalized();
    views_.move(other, moved);
  }
}

}  // namespace fathom
