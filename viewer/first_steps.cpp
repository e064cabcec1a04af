#include "viewer/first_steps.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

#include <imgui.h>

#include "exam/state_folder.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

struct Purpose {
  const char* pane;
  const char* text;
};
constexpr std::array<Purpose, 4> kPurposes{
    {{"Outline", "Space: where the frames lie, what was outlined on them, and the surface through it."},
     {"Reslice", "Planes through the recording, moved by their handles."},
     {"Measurements", "Structures with their volumes, as soon as two frames are outlined."},
     {"Timeline", "All frames, and which of them are outlined. Drag to go through them."}}};

struct Step {
  const char* menu;
  const char* label;
  const char* about;
};
constexpr std::array<Step, 3> kSteps{{{"File", "Open...", "an exam or a recording; or drop one on the window"},
                                      {"Window", "Live", "record from a scanner and a tracker"},
                                      {"Help", "Keys and mouse", "everything done often has a key"}}};

// A button that does what the action does.
void action_button(const std::vector<Action>& actions, const char* menu, const char* label) {
  const auto found = std::find_if(actions.begin(), actions.end(),
                                  [&](const Action& action) { return action.menu == menu && action.label == label; });
  if (found == actions.end()) return;
  ImGui::PushID(menu);
  if (ImGui::Button(label)) found->run();
  ui::note_last(std::string("welcome:") + label);
  ImGui::PopID();
}

}  // namespace

void draw_welcome(const std::vector<Action>& actions, bool hides_names) {
  const float indent = ui::em();
  ImGui::Dummy({1.0F, ui::em()});
  ImGui::Indent(indent);
  ImGui::TextUnformatted("Nothing is open.");
  ImGui::Dummy({1.0F, 0.3F * ui::em()});
  for (const Step& step : kSteps) {
    action_button(actions, step.menu, step.label);
    ImGui::SameLine(11.0F * ui::em());
    ImGui::TextWrapped("%s", step.about);
  }
  const Action* chosen = nullptr;
  bool first = true;
  for (const Action& action : actions) {
    if (hides_names || action.menu != kRecentMenu) continue;
    if (std::exchange(first, false)) {
      ImGui::Dummy({1.0F, ui::em()});
      ImGui::TextDisabled("Open before");
    }
    if (ImGui::Selectable(action.label.c_str())) chosen = &action;
    ui::note_last("recent:" + action.label);
  }
  ImGui::Unindent(indent);
  if (chosen != nullptr) chosen->run();
}

void draw_purpose(const char* pane) {
  const auto found = std::find_if(kPurposes.begin(), kPurposes.end(),
                                  [&](const Purpose& purpose) { return std::strcmp(purpose.pane, pane) == 0; });
  if (found == kPurposes.end()) return;
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextWrapped("%s", found->text);
  ImGui::PopStyleColor();
}

void draw_calibration_missing(Session& session, const std::vector<Action>& actions) {
  ImGui::TextWrapped(
      "Without a calibration nobody knows where the frames are, and nothing can be measured. Drop a "
      "calibration file on the window, or choose one.");
  action_button(actions, "File", "Calibration...");
  const std::filesystem::path beside = session.calibration_beside();
  if (beside.empty()) return;
  const std::string name = session.view.hides_names ? "the calibration beside" : beside.filename().string();
  if (ImGui::Button(("Use " + name).c_str())) {
    session.attempt(beside.filename().string(), [&] { session.document()->set_calibration(beside); });
  }
  ui::note_last("Use the calibration beside");
}

}  // namespace fathom
