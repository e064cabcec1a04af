#include "viewer/widgets.h"

#include <algorithm>
#include <utility>

#include <imgui_stdlib.h>

namespace fathom::ui {

namespace {

// As Dear ImGui's own state, there is one of these for the one window.
Places current_places;
Places last_places;

std::string visible(const char* label) {
  const std::string text = label;
  const std::string shown = text.substr(0, text.find("##"));
  return shown.empty() ? text.substr(2) : shown;
}

void copied_text(const std::string& text, ImU32 color) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  if (ImGui::IsItemClicked()) ImGui::SetClipboardText(text.c_str());
  tip("Click to copy");
}

}  // namespace

void new_frame() { last_places = std::exchange(current_places, Places()); }

const Places& places() { return last_places; }

void note(const std::string& name, ImVec2 low, ImVec2 high) { current_places.items[name] = {low, high}; }

void note_last(const std::string& name) { note(name, ImGui::GetItemRectMin(), ImGui::GetItemRectMax()); }

void tip(const char* text) {
  if (text != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", text);
}

void fault(const std::string& text) { copied_text(text, IM_COL32(255, 110, 100, 255)); }

void warning(const std::string& text) { copied_text(text, IM_COL32(240, 180, 70, 255)); }

bool button(const char* label, const char* about, bool pressed, bool enabled) {
  if (pressed) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  ImGui::BeginDisabled(!enabled);
  const bool clicked = ImGui::Button(label);
  ImGui::EndDisabled();
  if (pressed) ImGui::PopStyleColor();
  note_last(visible(label));
  tip(about);
  return clicked;
}

bool check(const char* label, bool& value, const char* about) {
  const bool changed = ImGui::Checkbox(label, &value);
  note_last(visible(label));
  tip(about);
  return changed;
}

bool combo(const char* label, int& index, const std::vector<std::string>& names, float width) {
  bool changed = false;
  ImGui::SetNextItemWidth(width);
  const bool known = index >= 0 && index < static_cast<int>(names.size());
  const bool open = ImGui::BeginCombo(label, known ? names[static_cast<std::size_t>(index)].c_str() : "");
  note_last(visible(label));
  if (!open) return false;
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    ImGui::PushID(i);
    if (ImGui::Selectable(names[static_cast<std::size_t>(i)].c_str(), i == index)) {
      changed = i != index;
      index = i;
    }
    note_last(visible(label) + ":" + names[static_cast<std::size_t>(i)]);
    ImGui::PopID();
  }
  ImGui::EndCombo();
  return changed;
}

bool text(const char* label, std::string& value, float width) {
  if (width != 0.0F) ImGui::SetNextItemWidth(width);
  const bool changed = ImGui::InputText(label, &value);
  note_last(visible(label));
  return changed;
}

bool slider(const char* label, float& value, float low, float high, const char* format, float width) {
  if (width != 0.0F) ImGui::SetNextItemWidth(width);
  const bool changed = ImGui::SliderFloat(label, &value, low, high, format, ImGuiSliderFlags_AlwaysClamp);
  note_last(visible(label));
  return changed;
}

bool splitter(const char* name, bool vertical, ImVec2 at, float across, float length, float& share) {
  const float width = kSplitter * em() / 15.0F;
  ImGui::SetCursorScreenPos(at);
  ImGui::InvisibleButton(name, vertical ? ImVec2(width, across) : ImVec2(across, width));
  note_last(name);
  const bool active = ImGui::IsItemActive();
  if (active || ImGui::IsItemHovered()) {
    ImGui::SetMouseCursor(vertical ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
  }
  const ImGuiCol color = active                   ? ImGuiCol_SeparatorActive
                         : ImGui::IsItemHovered() ? ImGuiCol_SeparatorHovered
                                                  : ImGuiCol_Separator;
  ImGui::GetWindowDrawList()->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                                            ImGui::GetColorU32(color, 0.6F));
  if (!active || length <= 0.0F) return false;
  const float moved = vertical ? ImGui::GetIO().MouseDelta.x : ImGui::GetIO().MouseDelta.y;
  if (moved == 0.0F) return false;
  share = std::clamp(share + moved / length, 0.08F, 0.92F);
  return true;
}

float em() { return ImGui::GetFontSize(); }

}  // namespace fathom::ui
