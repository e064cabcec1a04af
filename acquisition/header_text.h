#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/printable.h"

namespace fathom {

class InputFile;

// The text of a recording's header: its lines, words and numbers. Nothing here depends on the user's locale.

/// Without blanks, tabs and carriage returns at either end.
std::string_view trimmed(std::string_view text);

bool equal_ignoring_case(std::string_view a, std::string_view b);

/// The words between blanks and tabs.
std::vector<std::string_view> words(std::string_view text);

/// A whole number >= 0 that fills the text; empty when it is anything else or does not fit.
std::optional<std::uint64_t> parse_count(std::string_view text);

/// Exactly out.size() finite numbers separated by blanks; false when there are more, fewer, or others.
bool parse_reals(std::string_view text, std::span<double> out);

/// The lines of a file, read in pieces: a header of any length takes one buffer of memory.
class HeaderLines {
 public:
  explicit HeaderLines(const InputFile& file);

  /// The next line without its end ("\n" or "\r\n"); empty after the last. Valid until the next call. Throws Error
  /// when a line is too long for a header, or the header as a whole is.
  std::optional<std::string_view> next();

  /// Number of the last line, from 1.
  std::uint64_t line_number() const { return line_number_; }
  /// Position in the file just behind the last line.
  std::uint64_t position() const { return buffer_position_ + begin_; }
  /// Whether the last line ended with a line end, not with the file.
  bool line_was_ended() const { return line_was_ended_; }

  /// Throws Error naming the file and the last line's number.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const InputFile& file_;
  std::unique_ptr<char[]> buffer_;
  std::uint64_t buffer_position_ = 0;  ///< of the buffer's first byte in the file
  std::size_t begin_ = 0;              ///< of what is not handed out yet
  std::size_t end_ = 0;
  std::uint64_t line_number_ = 0;
  bool line_was_ended_ = true;
};

}  // namespace fathom
