#pragma once

#include <string>
#include <vector>

namespace fathom {

/// One thing that the user did, or a script in his place: both go into the same queue of the window.
struct InputEvent {
  enum class Kind { kMove, kButton, kWheel, kKey, kText, kDrop, kClose };

  Kind kind = Kind::kMove;
  double x = 0.0;  ///< kMove: pixels from the window's top left corner; kWheel: steps to the right
  double y = 0.0;  ///< kMove: the same, downward; kWheel: steps upward, away from the user
  int code = 0;    ///< kButton: 0 left, 1 right, 2 middle; kKey: as GLFW numbers it
  bool down = false;
  unsigned text = 0;                    ///< kText: one character
  std::vector<std::string> paths = {};  ///< kDrop
};

/// Shift, Ctrl, Alt and Super, as GLFW's numbers for modifiers.
struct KeyChord {
  int key = 0;  ///< as GLFW numbers it; 0: none
  bool ctrl = false;
  bool shift = false;
  bool alt = false;

  bool operator==(const KeyChord&) const = default;
};

/// "Ctrl+Shift+S"; empty without a key.
std::string chord_text(const KeyChord& chord);

/// The same back. Throws Error for a key that nobody knows.
KeyChord parse_chord(const std::string& text);

}  // namespace fathom
