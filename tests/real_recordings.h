#pragma once

#include <filesystem>

namespace fathom {

/// Folder of the PLUS project's recordings beside the checkout. Tests that need them are skipped where it is absent.
std::filesystem::path real_recordings();

}  // namespace fathom
