#include "tests/real_recordings.h"

namespace fathom {

std::filesystem::path real_recordings() { return std::filesystem::path(FATHOM_SOURCE_DIR) / "../shared/data/plus"; }

}  // namespace fathom
