#pragma once

#include <filesystem>

namespace fathom {

struct ViewerOptions {
  std::filesystem::path open;         ///< an exam or a recording; empty: nothing
  std::filesystem::path calibration;  ///< of a recording; empty: none
  std::filesystem::path contours;     ///< of a recording; empty: none
  std::filesystem::path script;       ///< empty: the user's hands
};

/// Opens the window and returns when it was closed, or the script has ended. What the user can mend is said in the
/// window; throws Error where there can be none (no display, no OpenGL 3.3), and where a script fails.
void run_viewer(const ViewerOptions& options);

}  // namespace fathom
