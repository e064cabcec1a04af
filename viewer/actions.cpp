#include "viewer/actions.h"

#include <algorithm>
#include <array>

#include <imgui.h>

#include "viewer/widgets.h"

namespace fathom {

namespace {

// What the mouse does, which no key table knows.
struct MouseHelp {
  const char* what;
  const char* does;
};
constexpr std::array<MouseHelp, 8> kMouse{
    {{"Wheel over the image", "next and previous frame"},
     {"Ctrl + wheel over the image", "zoom about the pointer"},
     {"Middle drag, or left drag with Browse", "move the image"},
     {"Right drag over the image", "window (across) and level (down)"},
     {"Left drag in Outline", "turn; with Shift or the right button, move; wheel: zoom; double click: show all"},
     {"Drag a dividing plane's handle", "move the plane along its normal; with Shift, tilt it"},
     {"Left drag with Draw", "outline free-hand; clicks set points, one on the first point closes"},
     {"Left drag with Points", "move a point; on the line between points, insert one"}}};

bool is_enabled(const Action& action) { return !action.enabled || action.enabled(); }

}  // namespace

void draw_menus(const std::vector<Action>& actions) {
  std::vector<std::string> menus;
  for (const Action& action : actions) {
    if (std::find(menus.begin(), menus.end(), action.menu) == menus.end()) menus.push_back(action.menu);
  }
  for (const std::string& menu : menus) {
    if (menu.empty()) continue;
    const bool open = ImGui::BeginMenu(menu.c_str());
    ui::note_last("menu:" + menu);
    if (!open) continue;
    for (const Action& action : actions) {
      if (action.menu != menu) continue;
      const bool on = action.checked && action.checked();
      const bool clicked =
          ImGui::MenuItem(action.label.c_str(), chord_text(action.key).c_str(), on, is_enabled(action));
      ui::note_last("menu:" + menu + "/" + action.label);
      ui::tip(action.about.empty() ? nullptr : action.about.c_str());
      if (clicked) action.run();
    }
    ImGui::EndMenu();
  }
}

void handle_keys(const std::vector<Action>& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return;
  for (const Action& action : actions) {
    const KeyChord& chord = action.key;
    if (chord.key == 0 || !ImGui::IsKeyPressed(chord.key, action.repeats)) continue;
    if (io.KeyCtrl != chord.ctrl || io.KeyShift != chord.shift || io.KeyAlt != chord.alt) continue;
    if (is_enabled(action)) action.run();
    return;
  }
}

void draw_help(const std::vector<Action>& actions, bool& open) {
  if (!open) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5F * size.x, 0.5F * size.y}, ImGuiCond_Appearing, {0.5F, 0.5F});
  ImGui::SetNextWindowSize({std::min(46.0F * ui::em(), size.x), 0.8F * size.y}, ImGuiCond_Appearing);
  if (ImGui::Begin("Keys and mouse", &open, ImGuiWindowFlags_NoCollapse)) {
    ui::note("pane:Help", ImGui::GetWindowPos(),
             {ImGui::GetWindowPos().x + ImGui::GetWindowWidth(), ImGui::GetWindowPos().y + ImGui::GetWindowHeight()});
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
      const auto row = [](const std::string& left, const std::string& right) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", left.c_str());
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", right.c_str());
      };
      for (const Action& action : actions) {
        if (action.key.key != 0)
          row(chord_text(action.key), action.label + (action.about.empty() ? "" : ": " + action.about));
      }
      for (const MouseHelp& help : kMouse) row(help.what, help.does);
      ImGui::EndTable();
    }
  }
  ImGui::End();
}

std::string keys_markdown(const std::vector<Action>& actions) {
  std::string text = "| key or mouse | does |\n| --- | --- |\n";
  for (const Action& action : actions) {
    if (action.key.key == 0) continue;
    text += "| " + chord_text(action.key) + " | " + action.label + (action.about.empty() ? "" : ": " + action.about) +
            " |\n";
  }
  for (const MouseHelp& help : kMouse) text += std::string("| ") + help.what + " | " + help.does + " |\n";
  return text;
}

}  // namespace fathom
