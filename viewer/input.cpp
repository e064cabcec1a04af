#include "viewer/input.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/printable.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fathom {

namespace {

struct KeyName {
  int key;
  const char* name;
};

// Letters, digits and signs are their own names (GLFW numbers them as ASCII does).
constexpr std::array<KeyName, 32> kNames{{{GLFW_KEY_SPACE, "Space"},
                                          {GLFW_KEY_ESCAPE, "Escape"},
                                          {GLFW_KEY_ENTER, "Enter"},
                                          {GLFW_KEY_TAB, "Tab"},
                                          {GLFW_KEY_BACKSPACE, "Backspace"},
                                          {GLFW_KEY_INSERT, "Insert"},
                                          {GLFW_KEY_DELETE, "Delete"},
                                          {GLFW_KEY_RIGHT, "Right"},
                                          {GLFW_KEY_LEFT, "Left"},
                                          {GLFW_KEY_DOWN, "Down"},
                                          {GLFW_KEY_UP, "Up"},
                                          {GLFW_KEY_PAGE_UP, "Page Up"},
                                          {GLFW_KEY_PAGE_DOWN, "Page Down"},
                                          {GLFW_KEY_HOME, "Home"},
                                          {GLFW_KEY_END, "End"},
                                          {GLFW_KEY_F1, "F1"},
                                          {GLFW_KEY_F2, "F2"},
                                          {GLFW_KEY_F3, "F3"},
                                          {GLFW_KEY_F4, "F4"},
                                          {GLFW_KEY_F5, "F5"},
                                          {GLFW_KEY_F6, "F6"},
                                          {GLFW_KEY_F7, "F7"},
                                          {GLFW_KEY_F8, "F8"},
                                          {GLFW_KEY_F9, "F9"},
                                          {GLFW_KEY_F10, "F10"},
                                          {GLFW_KEY_F11, "F11"},
                                          {GLFW_KEY_F12, "F12"},
                                          {GLFW_KEY_LEFT_SHIFT, "Shift"},
                                          {GLFW_KEY_LEFT_CONTROL, "Ctrl"},
                                          {GLFW_KEY_LEFT_ALT, "Alt"},
                                          {GLFW_KEY_KP_ADD, "Keypad +"},
                                          {GLFW_KEY_KP_SUBTRACT, "Keypad -"}}};

std::string key_text(int key) {
  const auto* found = std::find_if(kNames.begin(), kNames.end(), [&](const KeyName& name) { return name.key == key; });
  if (found != kNames.end()) return found->name;
  return key > ' ' && key < 0x7f ? std::string(1, static_cast<char>(key)) : std::string();
}

bool take_prefix(std::string& text, const std::string& prefix) {
  if (text.size() <= prefix.size() || text.compare(0, prefix.size(), prefix) != 0) return false;
  text.erase(0, prefix.size());
  return true;
}

}  // namespace

std::string chord_text(const KeyChord& chord) {
  if (chord.key == 0) return {};
  std::string text;
  if (chord.ctrl) text += "Ctrl+";
  if (chord.shift) text += "Shift+";
  if (chord.alt) text += "Alt+";
  return text + key_text(chord.key);
}

KeyChord parse_chord(const std::string& text) {
  KeyChord chord;
  std::string rest = text;
  chord.ctrl = take_prefix(rest, "Ctrl+");
  chord.shift = take_prefix(rest, "Shift+");
  chord.alt = take_prefix(rest, "Alt+");
  const auto* found =
      std::find_if(kNames.begin(), kNames.end(), [&](const KeyName& name) { return rest == name.name; });
  if (found != kNames.end()) {
    chord.key = found->key;
  } else if (rest.size() == 1 && rest.front() > ' ' && rest.front() < 0x7f) {
    const char c = rest.front();
    chord.key = c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
  } else {
    throw Error("'" + printable(text) + "' is no key; write it as the help page does, such as Ctrl+Shift+S");
  }
  return chord;
}

}  // namespace fathom
