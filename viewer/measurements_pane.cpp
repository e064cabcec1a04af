#include "viewer/measurements_pane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <imgui.h>

#include "core/numbers.h"
#include "viewer/look.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr std::array<const char*, kExamTexts> kTexts{"Patient", "Operator", "Date", "Notes"};

void error_line(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 110, 100, 255));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  if (ImGui::IsItemClicked()) ImGui::SetClipboardText(text.c_str());
  ui::tip("Click to copy");
}

void warning_line(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(240, 180, 70, 255));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  if (ImGui::IsItemClicked()) ImGui::SetClipboardText(text.c_str());
}

std::string ml_text(const std::optional<double>& ml) { return ml ? format_rounded(*ml, 2) + " ml" : "-"; }

void row(const char* name, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
}

}  // namespace

void MeasurementsPane::draw(Session& session) {
  const Document* document = session.document();
  if (document == nullptr) return;
  const ImVec2 low = ImGui::GetWindowPos();
  ui::note("pane:Measurements", low, {low.x + ImGui::GetWindowWidth(), low.y + ImGui::GetWindowHeight()});
  if (!document->is_calibrated()) {
    warning_line("No calibration: nothing can be measured. Drop a calibration file on the window.");
  }
  for (std::size_t i = 0; i < document->structures().size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    draw_structure(session, i);
    ImGui::PopID();
    if (i >= document->structures().size()) break;
  }
  if (ui::button("Add structure", "Another organ or lesion, with outlines of its own")) {
    session.attempt("structure", [&] {
      Structure structure;
      structure.name = "structure " + std::to_string(session.document()->structures().size() + 1);
      structure.color.clear();
      session.view.structure = session.document()->add_structure(std::move(structure));
    });
  }
  draw_planes(session);
  draw_texts(session);
}

void MeasurementsPane::draw_structure(Session& session, std::size_t index) {
  draw_style(session, index);
  if (index >= session.document()->structures().size()) return;
  const std::uint64_t id = session.document()->content().ids[index];
  const StructureView* view = session.find_structure(id);
  if (view != nullptr && session.document()->is_calibrated()) {
    draw_volumes(session, index);
    const bool measured = view->volumes.cubic_ml.has_value();
    if (!measured && !view->warnings.empty()) error_line(view->warnings.front());
    if (measured && !view->surface.fault.empty()) error_line("Surface: " + view->surface.fault);
    if (view->surface.cancelled) {
      warning_line("Surface: cancelled; what is shown is of an earlier state, if anything");
      if (ui::button("Make the surface", "After all")) session.retry_surface(id);
    }
    if (session.active_structure() == index) {
      draw_graph(session, index);
      for (const std::string& warning : view->warnings) warning_line(warning);
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

void MeasurementsPane::update_ellipsoid(const Session& session, std::size_t index) {
  const Document& document = *session.document();
  Ellipsoid& kept = ellipsoids_[document.content().ids[index]];
  const std::uint64_t revision = document.structure_revision(index) + document.placement_revision();
  if (kept.revision == revision) return;
  kept.revision = revision;
  kept.volume = ellipsoid_volume(document.structures()[index], document.scan()->locators.front(), 0);
}

void MeasurementsPane::draw_volumes(const Session& session, std::size_t index) {
  update_ellipsoid(session, index);
  const std::uint64_t id = session.document()->content().ids[index];
  const StructureView& view = *session.find_structure(id);
  if (!ImGui::BeginTable("volumes", 2, ImGuiTableFlags_SizingStretchProp)) return;
  row("Sections", std::to_string(view.section_count));
  row("Volume", ml_text(view.volumes.cubic_ml));
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted("Change");
  ui::tip("Since the last action");
  ImGui::TableNextColumn();
  std::string change = "-";
  if (view.volumes.cubic_ml && view.volume_before_ml) {
    const double step = *view.volumes.cubic_ml - *view.volume_before_ml;
    change = (step >= 0.0 ? "+" : "") + format_rounded(step, 2) + " ml";
    if (*view.volume_before_ml > 0.0) {
      const double percent = 100.0 * step / *view.volume_before_ml;
      change += std::string(" (") + (percent >= 0.0 ? "+" : "") + format_rounded(percent, 1) + " %)";
    }
  }
  ImGui::TextUnformatted(change.c_str());
  row("Surface", ml_text(view.surface.volume_ml));
  const auto& ellipsoid = ellipsoids_.at(id).volume;
  if (ellipsoid) {
    const Eigen::Vector3d& d = ellipsoid->diameters_mm;
    row("L x W x H x 0.52", ml_text(ellipsoid->volume_ml));
    row("", format_rounded(d[0], 1) + " x " + format_rounded(d[1], 1) + " x " + format_rounded(d[2], 1) + " mm");
  }
  ImGui::EndTable();
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
  std::snprintf(text, sizeof text, "area, up to %.2f cm2, along %.0f mm", largest / 100.0, way.back());
  list.AddText({low.x + margin, low.y + 1.0F}, ImGui::GetColorU32(ImGuiCol_Text), text);
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("frame %d: %.2f cm2", view.sections[nearest].frame,
                      view.sections[nearest].vector_area_mm2.norm() / 100.0);
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) session.show_frame(view.sections[nearest].frame);
  }
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
