#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fathom {

/// Text from a file, fit for a message: control characters and bytes beyond ASCII that are no valid UTF-8 are replaced
/// by '?', and what is longer than `longest` bytes is cut with "...".
std::string printable(std::string_view text, std::size_t longest = 60);

}  // namespace fathom
