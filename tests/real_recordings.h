#pragma once

#include <filesystem>

namespace fathom {

/// Folder of the PLUS project's recordings beside the checkout. Tests that need them are skipped where it is absent.
std::filesystem::path real_recordings();

}  // namespace fathom

/// The first statement of a test that needs the recordings.
#define FATHOM_NEEDS_REAL_RECORDINGS()                       \
  if (!std::filesystem::exists(::fathom::real_recordings())) \
  GTEST_SKIP() << "not checked: the recordings of data/plus are not beside the project"
