#pragma once

#include <filesystem>
#include <string>

namespace fathom {

/// What is kept of the window between two sessions.
struct Settings {
  int width = 1280;
  int height = 800;
  bool dark = true;
  float scale = 0.0F;    ///< of texts; 0: as the display asks
  float left = 0.50F;    ///< shares of the panes: Review of the width
  float middle = 0.58F;  ///< Outline and Reslice of what is left of it
  float upper = 0.60F;   ///< Outline of Outline and Reslice
  float main = 0.86F;    ///< all of these of the height, the Timeline below
  bool show_outline = true;
  bool show_reslice = true;
  bool show_measurements = true;
  bool show_timeline = true;
  std::string image_source;  ///< of the last live session
  std::string tracker_source;
};

/// `viewer.json` in Fathom's folder under XDG_CONFIG_HOME, else ~/.config.
std::filesystem::path settings_file();

/// What the file holds, as far as it can be read: a damaged file is as good as none.
Settings read_settings(const std::filesystem::path& file);
/// Throws Error.
void write_settings(const Settings& settings, const std::filesystem::path& file);

}  // namespace fathom
