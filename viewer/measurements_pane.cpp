#include "viewer/measurements_pane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <imgui.h>

#include "viewer/look.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr std::array<const char*, kExamTexts> kTexts{"Patient", "Operator", "Date", "Notes"};

}  // namespace

void MeasurementsPane::draw(Session& session) {
  const Document* document = session.document();
  if (document == nullptr) return;
  const ImVec2 low = ImGui::GetWindowPos();
  ui::note("pane:Measurements", low, {low.x + ImGui::GetWindowWidth(), low.y + ImGui::GetWindowHeight()});
  if (!document->is_calibrated()) {
    ui::warning("No calibration: nothing can be measured. Drop a calibration file on the window.");
  }
  // Above what grows, so that it is always in sight.
  if (ui::button("Add structure", "Another organ or lesion, with outlines of its own")) {
    session.attempt("structure", [&] {
      Structure structure;
      structure.name = "structure " + std::to_string(session.document()->structures().size() + 1);
      structure.color.clear();
      session.view.structure = session.document()->add_structure(std::move(structure));
    });
  }
  for (std::size_t i = 0; i < document->structures().size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    draw_structure(session, i);
    ImGui::PopID();
    if (i >= document->structures().size()) break;
  }
  draw_planes(session);
  if (!session.view.hides_names) draw_texts(session);
}

void MeasurementsPane::draw_structure(Session& session, std::size_t index) {
  draw_style(session, index);
  if (index >= session.document()->structures().size()) return;
  const std::uint64_t id = session.document()->content().ids[index];
  const StructureView* view = session.find_structure(id);
  if (view != nullptr && session.document()->is_calibrated()) {
    draw_volumes(session, index);
    const bool measured = view->volumes.recommended_ml().has_value();
    if (!measured && !view->warnings.empty()) ui::fault(session.text_to_show(view->warnings.front()));
    if (measured && !view->surface.fault.empty()) ui::fault("Surface: " + session.text_to_show(view->surface.fault));
    if (view->surface.cancelled) {
      ui::warning("Surface: cancelled; what is shown is of an earlier state, if anything");
      if (ui::button("Make the surface", "After all")) session.retry_surface(id);
    }
    if (session.active_structure() == index) {
      draw_graph(session, index);
      for (const std::string& warning : view->warnings) ui::warning(session.text_to_show(warning));
    }
  }
  ImGui::Separator();
}

void MeasurementsPane::draw_style(Session& session, std::size_t index) {
  Document& document = *session.document();
  // Copies, as edits replace the structure; not of its outlines.
  const std::string structure_name = document.structures()[index].name;
  const std::string structure_color = document.structures()[index].color;
  const std::uint64_t id = document.content().ids[index];
  const bool active = session.active_structure() == index;
  if (ImGui::RadioButton("##active", active)) session.view.structure = index;
  ui::note_last("structure " + std::to_string(index + 1));
  ui::tip("Tools work on this structure");
  ImGui::SameLine();
  ImVec4 color = ImGui::ColorConvertU32ToFloat4(packed_color(structure_color.c_str()));
  if (ImGui::ColorEdit3("##color", &color.x, ImGuiColorEditFlags_NoInputs)) {
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(std::lround(255.0F * color.x)),
                  static_cast<unsigned>(std::lround(255.0F * color.y)),
                  static_cast<unsigned>(std::lround(255.0F * color.z)));
    session.attempt(structure_name, [&] { document.recolor_structure(index, text); });
  }
  ImGui::SameLine();
  draw_opacity(session, index);
  ImGui::SameLine();
  if (named_ != id) name_ = structure_name;
  std::string& name = name_;
  ImGui::SetNextItemWidth(-2.2F * ui::em());
  ui::text(("##name" + std::to_string(index)).c_str(), name);
  if (ImGui::IsItemActive()) named_ = id;
  if (ImGui::IsItemDeactivated() && named_ == id) {
    const std::string wanted = name;
    named_ = 0;
    if (wanted != structure_name) session.attempt(structure_name, [&] { document.rename_structure(index, wanted); });
  }
  ImGui::SameLine();
  const std::string remove = "x##remove structure " + std::to_string(index + 1);
  if (ImGui::Button(remove.c_str())) {
    session.attempt(structure_name, [&] { document.remove_structure(index); });
  }
  ui::note_last("remove structure " + std::to_string(index + 1));
  ui::tip("Remove this structure with all of its outlines (can be undone)");
}

// Areas over the way of the centroids; a click shows the section's frame.
void MeasurementsPane::draw_graph(Session& session, std::size_t index) {
  const StructureView& view = *session.find_structure(session.document()->content().ids[index]);
  if (view.sections.size() < 2) return;
  std::vector<double> way{0.0};
  double largest = 0.0;
  for (std::size_t i = 0; i < view.sections.size(); ++i) {
    if (i > 0) way.push_back(way.back() + (view.sections[i].centroid_mm - view.sections[i - 1].centroid_mm).norm());
    largest = std::max(largest, view.sections[i].vector_area_mm2.norm());
  }
  if (!(largest > 0.0) || !(way.back() > 0.0)) return;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, 6.0F * ui::em());
  ImGui::InvisibleButton("areas", size);
  ui::note_last("area graph");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, {low.x + size.x, low.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  const float margin = 4.0F;
  std::vector<ImVec2> points;
  for (std::size_t i = 0; i < view.sections.size(); ++i) {
    const auto across = static_cast<float>(way[i] / way.back());
    const auto up = static_cast<float>(view.sections[i].vector_area_mm2.norm() / largest);
    points.push_back({low.x + margin + across * (size.x - 2.0F * margin),
                      low.y + size.y - margin - up * (size.y - 1.5F * ui::em() - 2.0F * margin)});
  }
  const ImU32 color = packed_color(session.document()->structures()[index].color.c_str());
  list.AddPolyline(points.data(), static_cast<int>(points.size()), color, 0, 1.5F);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool shown = view.sections[i].frame == session.view.frame;
    list.AddCircleFilled(points[i], shown ? 4.0F : 2.5F, shown ? IM_COL32(255, 235, 60, 255) : color);
    if (std::abs(points[i].x - mouse.x) < std::abs(points[nearest].x - mouse.x)) nearest = i;
  }
  char text[96];
  std::snprintf(text, sizeof text, "up to %.2f cm2, along %.0f mm", largest / 100.0, way.back());
  list.AddText({low.x + margin, low.y + 1.0F}, ImGui::GetColorU32(ImGuiCol_Text), text);
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("frame %d: %.2f cm2", view.sections[nearest].frame,
                      view.sections[nearest].vector_area_mm2.norm() / 100.0);
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) session.show_frame(view.sections[nearest].frame);
  }
}

// A drag of the slider is one action.
void MeasurementsPane::draw_opacity(Session& session, std::size_t index) {
  Document& document = *session.document();
  const std::string name = document.structures()[index].name;
  float percent = static_cast<float>(100.0 * document.structures()[index].opacity);
  const std::string label = "##opacity " + std::to_string(index + 1);
  const bool moved = ui::slider(label.c_str(), percent, 0.0F, 100.0F, "%.0f %%", 3.0F * ui::em());
  ui::tip("How solid the surface is in Outline");
  // Also where a key ended the action, so that what is left of the drag is one.
  if (ImGui::IsItemActive() && !document.in_action()) document.begin_action("Change opacity");
  if (moved) session.attempt(name, [&] { document.set_opacity(index, std::round(percent) / 100.0); });
  if (ImGui::IsItemDeactivated() && document.in_action()) document.end_action();
}

void MeasurementsPane::draw_planes(Session& session) {
  Document& document = *session.document();
  if (!document.is_calibrated()) return;
  const bool open = ImGui::CollapsingHeader("Dividing planes");
  ui::note_last("Dividing planes");
  if (!open) return;
  if (ui::button("Place planes", "Between all sweeps, midway between the sides that face each other")) {
    session.attempt("dividing planes", [&] {
      for (const std::string& warning : document.place_planes()) session.say("dividing planes", warning, false);
    });
  }
  const std::vector<DividingPlane> planes = document.content().planes;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string name = "plane " + std::to_string(i + 1);
    const Eigen::Vector3d normal = planes[i].normal();
    ImGui::Text("%zu: normal %.2f %.2f %.2f, %.1f mm", i + 1, normal.x(), normal.y(), normal.z(), -planes[i].offset());
    ImGui::SameLine();
    if (ui::button(("x##remove " + name).c_str(), "Remove this plane")) {
      session.attempt(name, [&] { document.remove_plane(i); });
      break;
    }
  }
}

void MeasurementsPane::draw_texts(Session& session) {
  Document& document = *session.document();
  const bool open = ImGui::CollapsingHeader("Exam");
  ui::note_last("Exam");
  if (!open) return;
  for (std::size_t i = 0; i < kExamTexts; ++i) {
    const auto which = static_cast<ExamText>(i);
    std::string shown = text_edited_ == static_cast<int>(i) ? text_ : document.text(which);
    ui::text(kTexts[i], shown, -5.0F * ui::em());
    if (ImGui::IsItemActive()) {
      text_edited_ = static_cast<int>(i);
      text_ = shown;
    }
    if (ImGui::IsItemDeactivated() && text_edited_ == static_cast<int>(i)) {
      text_edited_ = -1;
      session.attempt(kTexts[i], [&] { document.set_text(which, text_); });
    }
  }
}

}  // namespace fathom
