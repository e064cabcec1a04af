#include "viewer/calibration_beside.h"

#include <string>

namespace fathom {

std::filesystem::path find_calibration_beside(const std::filesystem::path& recording) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(recording, unreadable)) {
    const std::filesystem::path inside = recording / "calibration.json";
    return std::filesystem::is_regular_file(inside, unreadable) ? inside : std::filesystem::path();
  }
  // One ending after another is taken off the name.
  for (std::filesystem::path stem = recording.filename(); stem.has_extension();) {
    stem = stem.stem();
    const std::filesystem::path beside = recording.parent_path() / (stem.string() + ".calibration.json");
    if (std::filesystem::is_regular_file(beside, unreadable)) return beside;
  }
  return {};
}

}  // namespace fathom
