#pragma once

#include <string>

namespace fathom {

/// What tells this build of the program from every other: the linker's hash of all of it, in hexadecimal. Empty where
/// the linker left none.
std::string build_id();

}  // namespace fathom
