#pragma once

#include <map>
#include <string>
#include <vector>

#include <imgui.h>

namespace fathom {

/// Where the things of the last whole frame lie in the window, by name, so that a script can find them as the eye does.
struct Places {
  struct Area {
    ImVec2 low;
    ImVec2 high;
    ImVec2 middle() const { return {0.5F * (low.x + high.x), 0.5F * (low.y + high.y)}; }
  };
  std::map<std::string, Area> items;  ///< "Undo", "menu:File", "pane:review"
};

namespace ui {

/// Starts collecting places; what was collected before becomes places().
void new_frame();
const Places& places();
void note(const std::string& name, ImVec2 low, ImVec2 high);
/// Notes the widget that was drawn last.
void note_last(const std::string& name);

/// Widgets that are noted under their label, up to "##".
bool button(const char* label, const char* tip = nullptr, bool pressed = false, bool enabled = true);
bool check(const char* label, bool& value, const char* tip = nullptr);
bool combo(const char* label, int& index, const std::vector<std::string>& names, float width);
bool text(const char* label, std::string& value, float width = 0.0F);
bool slider(const char* label, float& value, float low, float high, const char* format = "%.1f", float width = 0.0F);
void tip(const char* text);
/// A text in the colour of faults or of warnings, which a click copies.
void fault(const std::string& text);
void warning(const std::string& text);

/// A bar between two panes, to be dragged: `share` is the first one's part of `length`. Vertical bars stand between
/// panes side by side.
bool splitter(const char* name, bool vertical, ImVec2 at, float across, float length, float& share);

inline constexpr float kSplitter = 5.0F;  ///< width, at scale 1

/// Texts and sizes grow with the font.
float em();

}  // namespace ui

}  // namespace fathom
