#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/input_file.h"

namespace fathom {

/// The file of a mesh, read forward as lines, characters or bytes: a file of any length takes one buffer of memory.
class MeshSource {
 public:
  /// Throws Error when the file cannot be opened, or is empty.
  explicit MeshSource(const std::filesystem::path& path);

  const std::string& name() const { return file_.name(); }
  std::uint64_t size() const { return file_.size(); }
  /// Bytes from what is read next to the end of the file.
  std::uint64_t remaining() const { return file_.size() - (buffer_position_ + begin_); }

  /// The file's first bytes, at most `count` <= 1024 of them, before anything was read.
  std::string_view first_bytes(std::size_t count);

  /// The next line without its end ("\n" or "\r\n"); empty after the last. Valid until the next read. Throws Error when
  /// a line is longer than a megabyte.
  std::optional<std::string_view> next_line();
  /// The next line that holds more than blanks and a comment from '#' on, without them; empty after the last.
  std::optional<std::string_view> next_line_of_data();

  /// The next character without taking it; empty at the end of the file.
  std::optional<char> peek();
  /// Takes the next character; there must be one.
  void skip() {
    if (buffer_[begin_++] == '\n') ++line_number_;
  }

  /// The next `count` <= 1024 bytes. Valid until the next read. Throws Error where the file ends before.
  const std::byte* bytes(std::size_t count);

  /// Number of the last line that next_line gave, or of line ends that skip took.
  std::uint64_t line_number() const { return line_number_; }

  /// Throws Error with the file's name before `what`.
  [[noreturn]] void fail(const std::string& what) const { file_.fail(what); }
  /// Throws Error with the file's name and the number of the last line.
  [[noreturn]] void fail_in_line(const std::string& what) const;
  [[noreturn]] void fail_cut_short() const;
  /// Throws Error where next_line_of_data saw a comment that promises the closing comment (see kEndPromise), but not
  /// that one. To be called at the end of the file.
  void require_promised_end() const;
  bool end_was_promised() const { return end_is_promised_; }

 private:
  bool refill();

  InputFile file_;
  std::unique_ptr<char[]> buffer_;
  std::uint64_t buffer_position_ = 0;  ///< of the buffer's first byte in the file
  std::size_t begin_ = 0;              ///< of what is not taken yet
  std::size_t end_ = 0;
  std::uint64_t line_number_ = 0;
  bool end_is_promised_ = false;
  bool end_was_seen_ = false;
};

/// Comments at the beginning and the end of what is written in formats that have no end of their own, by which a file
/// that was cut short is known.
inline constexpr std::string_view kEndPromise = "# A whole file ends with the line: # end";
inline constexpr std::string_view kEnd = "# end";

/// Takes the next word, between blanks and tabs, off the front of a line; empty where there is none.
std::string_view take_word(std::string_view& line);

/// The next word of the last line as a finite number. Throws Error where it is anything else.
double take_real(std::string_view& line, const MeshSource& source);

/// Three of them.
std::array<double, 3> take_vector(std::string_view& line, const MeshSource& source);

/// A word as a whole number; empty where it is anything else or does not fit.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// The next word of the last line as a number of things, 0 to 2^31 - 1. Throws Error, naming `what`, for anything else.
std::int32_t take_count(std::string_view& line, std::string_view what, const MeshSource& source);

}  // namespace fathom
