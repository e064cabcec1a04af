#include <string>

#include <imgui.h>

#include "core/numbers.h"
#include "viewer/measurements_pane.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

std::string ml_text(const std::optional<double>& ml) { return ml ? format_rounded(*ml, 2) + " ml" : "-"; }

void name_cell(const char* name, const char* tip = nullptr) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  if (tip != nullptr) ui::tip(tip);
  ImGui::TableNextColumn();
}

void row(const char* name, const std::string& value, const char* tip = nullptr) {
  name_cell(name, tip);
  ImGui::TextWrapped("%s", value.c_str());
}

// What the interval comes from.
std::string parts_text(const VolumeInterval& interval, bool divided) {
  std::string text = "Standard deviations in ml: by what lies between sections and the scatter of outlines " +
                     format_rounded(interval.spacing_ml, 2);
  text += "\nby the calibration, as far as it says how sure it is " + format_rounded(interval.calibration_ml, 2);
  text += "\nIt is of the part between the outer sections.";
  return divided ? text + "\nIts upper end has what is estimated to be missing at the dividing planes." : text;
}

std::string change_text(const PlanimetryVolumes& volumes, const std::optional<double>& before_ml) {
  const auto& now_ml = volumes.recommended_ml();
  if (!now_ml || !before_ml) return "-";
  const double step = *now_ml - *before_ml;
  std::string text = format_signed(step, 2) + " ml";
  if (*before_ml > 0.0) text += " (" + format_signed(100.0 * step / *before_ml, 1) + " %)";
  return text;
}

// Behind what stands there, or below it where there is no room.
void flow(const std::string& text) {
  ImGui::SameLine();
  if (ImGui::GetContentRegionAvail().x < ImGui::CalcTextSize(text.c_str()).x) ImGui::NewLine();
  ImGui::TextUnformatted(text.c_str());
}

void frame_button(Session& session, const std::string& label, const std::string& item, int frame) {
  if (ImGui::SmallButton((label + " " + std::to_string(frame) + "##" + item).c_str())) session.show_frame(frame);
  ui::note_last(item);
  ui::tip("Show this frame");
}

void draw_missing_end(Session& session, const MissingEnd& end, const std::string& item) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  frame_button(session, end.first ? "Before" : "After", item, end.frame);
  ImGui::TableNextColumn();
  ImGui::BeginGroup();
  if (end.volume_ml) {
    ImGui::TextUnformatted((format_rounded(*end.volume_ml, 2) + " ml missing").c_str());
    flow("(0 to " + format_rounded(end.high_ml, 2) + ")");
  } else {
    ImGui::TextWrapped("how much is missing cannot be told");
  }
  ImGui::EndGroup();
  ui::tip(warning_of(end).c_str());
}

}  // namespace

void MeasurementsPane::update_ellipsoid(const Session& session, std::size_t index) {
  const Document& document = *session.document();
  Ellipsoid& kept = ellipsoids_[document.content().ids[index]];
  const std::uint64_t revision = document.structure_revision(index) + document.placement_revision();
  if (kept.revision == revision) return;
  kept.revision = revision;
  kept.volume = ellipsoid_volume(document.structures()[index], document.scan()->locators.front(), 0);
}

void MeasurementsPane::draw_volumes(Session& session, std::size_t index) {
  update_ellipsoid(session, index);
  const std::uint64_t id = session.document()->content().ids[index];
  const StructureView& view = *session.find_structure(id);
  if (!ImGui::BeginTable("volumes", 2)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  row("Sections", std::to_string(view.section_count));
  row("Quadric volume", ml_text(view.volumes.recommended_ml()), "By quadric planimetry: the number to quote");
  if (view.volumes.recommended_ml()) draw_confidence(session, view, session.active_structure() == index);
  row("Change", change_text(view.volumes, view.volume_before_ml), "By the last action");
  row("Surface", ml_text(view.surface.volume_ml));
  const auto& ellipsoid = ellipsoids_.at(id).volume;
  if (ellipsoid) {
    const Eigen::Vector3d& d = ellipsoid->diameters_mm;
    const std::string sides =
        format_rounded(d[0], 1) + " x " + format_rounded(d[1], 1) + " x " + format_rounded(d[2], 1);
    const std::string about =
        sides + " mm x 0.52: length x width x height along the outlines' own axes, for comparison";
    row("Ellipsoid", ml_text(ellipsoid->volume_ml), about.c_str());
  }
  ImGui::EndTable();
}

// While an outline moves, what is known is of another state and not shown.
void MeasurementsPane::draw_confidence(Session& session, const StructureView& view, bool active) {
  name_cell("95 % interval");
  if (!view.confidence_is_current) return ImGui::TextDisabled("...");
  const LiveConfidence& known = view.confidence;
  const auto& interval = known.confidence.interval;
  const bool divided = !session.document()->content().planes.empty();
  if (known.cancelled) return ImGui::TextDisabled("cancelled");
  if (!known.fault.empty()) return ImGui::TextWrapped("%s", session.text_to_show(known.fault).c_str());
  if (interval) {
    ImGui::Text("%s to %s", format_rounded(interval->low_ml, 2).c_str(), format_rounded(interval->high_ml, 2).c_str());
    ui::tip(parts_text(*interval, divided).c_str());
  } else {
    ImGui::TextDisabled(divided ? "from four sections in every part on" : "from four sections on");
  }
  if (!active) return;
  if (const auto next = next_worth_outlining(known.confidence)) {
    name_cell("Outline next", "The frame whose outline would tell most about the volume");
    frame_button(session, "Frame", "outline next", next->frame);
    flow(format_rounded(next->gain_ml, 2) + " ml surer");
  }
  int number = 0;
  for (const MissingEnd& end : known.confidence.missing_ends) {
    draw_missing_end(session, end, "missing end " + std::to_string(++number));
  }
}

}  // namespace fathom
