#pragma once

#include <filesystem>
#include <vector>

namespace fathom {

/// Where the program keeps what it must know the next time: $XDG_STATE_HOME/fathom, by default ~/.local/state/fathom.
/// Empty where there is no such place. It need not exist yet.
std::filesystem::path state_folder();

/// Exams and recordings opened lately, the last one first, at most 12; those that are gone are left out. Never throws:
/// a damaged list is an empty one.
std::vector<std::filesystem::path> recent_files();

/// Puts one on top of the list. Nothing happens where the list cannot be written: it is a convenience.
void remember_recent(const std::filesystem::path& opened);

}  // namespace fathom
