#pragma once

#include <span>

#include "sim/scan_path.h"

namespace fathom {

/// How every object is swept in every pattern: one line for each pattern that serves any object, and one for each
/// object that needs its own.
std::span<const ScanGeometry> scan_table();

}  // namespace fathom
