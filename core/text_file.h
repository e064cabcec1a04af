#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace fathom {

/// The whole of a regular file of at most `max_bytes`. Throws Error when it is missing, not a regular file, larger, or
/// unreadable.
std::string read_text_file(const std::filesystem::path& path, std::uintmax_t max_bytes);

/// Replaces `path` by `text`, whole or not at all (see AtomicFile). Throws Error.
void write_text_file(const std::filesystem::path& path, const std::string& text);

}  // namespace fathom
