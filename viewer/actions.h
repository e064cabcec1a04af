#pragma once

#include <functional>
#include <string>
#include <vector>

#include "viewer/input.h"

namespace fathom {

/// Something that the user can have done by a menu or a key: the one table from which menus, keys, the help page and
/// the guide's table of keys are made.
struct Action {
  std::string menu;   ///< "File"
  std::string label;  ///< "Save as..."; unique in its menu
  KeyChord key;       ///< none: only by the menu
  std::string about;  ///< one line for the help page
  std::function<void()> run;
  std::function<bool()> enabled;  ///< empty: always
  std::function<bool()> checked;  ///< empty: neither on nor off
  bool repeats = false;           ///< while the key is held
};

/// The menu of what was open before.
inline constexpr const char* kRecentMenu = "Recent";

/// Draws the menus in the order of the table. `menu:File/Save` is where a script finds an entry.
void draw_menus(const std::vector<Action>& actions);

/// Runs the actions whose keys went down, unless a text is being typed.
void handle_keys(const std::vector<Action>& actions);

/// The help page: all keys.
void draw_help(const std::vector<Action>& actions, bool& open);

/// The same as a table in Markdown.
std::string keys_markdown(const std::vector<Action>& actions);

}  // namespace fathom
