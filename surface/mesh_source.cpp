#include "surface/mesh_source.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>

#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kBufferBytes = 1 << 20;  // no line of a mesh is that long; rubbish without line ends may be

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

MeshSource::MeshSource(const std::filesystem::path& path)
    : file_(path), buffer_(std::make_unique_for_overwrite<char[]>(kBufferBytes)) {
  if (file_.size() == 0) fail("is empty; copy it again");
}

bool MeshSource::refill() {
  if (begin_ > 0) std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
  buffer_position_ += begin_;
  end_ -= begin_;
  begin_ = 0;
  // Never beyond the length that the file had when it was opened, so that remaining() stays true.
  const std::uint64_t left = file_.size() - buffer_position_ - end_;
  const std::size_t room = static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes - end_, left));
  const std::size_t count =
      file_.read_some(buffer_position_ + end_, std::as_writable_bytes(std::span(buffer_.get() + end_, room)));
  if (count != room) fail_cut_short();
  end_ += count;
  return count > 0;
}

std::string_view MeshSource::first_bytes(std::size_t count) {
  if (end_ == 0) refill();
  return {buffer_.get(), std::min(count, end_)};
}

std::optional<std::string_view> MeshSource::next_line() {
  const void* found = std::memchr(buffer_.get() + begin_, '\n', end_ - begin_);
  if (found == nullptr) {
    const std::size_t searched = end_ - begin_;
    if (refill()) found = std::memchr(buffer_.get() + searched, '\n', end_ - searched);
  }
  if (begin_ == end_) return std::nullopt;
  ++line_number_;
  if (found == nullptr && end_ - begin_ == kBufferBytes) {
    fail_in_line("is longer than a megabyte; this is no mesh, or a damaged one");
  }
  const char* const begin = buffer_.get() + begin_;
  const auto length =
      static_cast<std::size_t>((found == nullptr ? buffer_.get() + end_ : static_cast<const char*>(found)) - begin);
  begin_ += length + (found == nullptr ? 0 : 1);
  std::string_view line(begin, length);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::optional<std::string_view> MeshSource::next_line_of_data() {
  while (auto line = next_line()) {
    end_is_promised_ = end_is_promised_ || *line == kEndPromise;
    end_was_seen_ = *line == kEnd;
    line = line->substr(0, line->find('#'));
    if (std::string_view rest = *line; !take_word(rest).empty()) return line;
  }
  return std::nullopt;
}

std::optional<char> MeshSource::peek() {
  if (begin_ == end_ && !refill()) return std::nullopt;
  return buffer_[begin_];
}

const std::byte* MeshSource::bytes(std::size_t count) {
  if (end_ - begin_ < count) refill();
  if (end_ - begin_ < count) fail_cut_short();
  const auto* const bytes = reinterpret_cast<const std::byte*>(buffer_.get() + begin_);
  begin_ += count;
  return bytes;
}

void MeshSource::fail_in_line(const std::string& what) const {
  fail("line " + std::to_string(line_number_) + " " + what);
}

void MeshSource::fail_cut_short() const { fail("ends in the middle of the mesh; it was cut short: copy it again"); }

void MeshSource::require_promised_end() const {
  if (end_is_promised_ && !end_was_seen_) fail_cut_short();
}

std::string_view take_word(std::string_view& line) {
  const auto begin = std::find_if_not(line.begin(), line.end(), is_blank);
  const auto end = std::find_if(begin, line.end(), is_blank);
  const std::string_view word(begin, end);
  line = {end, line.end()};
  return word;
}

double take_real(std::string_view& line, const MeshSource& source) {
  const std::string_view word = take_word(line);
  const auto value = parse_real(word);
  if (word.empty()) source.fail_in_line("has too few numbers; the file is damaged or was cut short: copy it again");
  if (!value) source.fail_in_line("has \"" + printable(word) + "\" in place of a finite number; write the mesh anew");
  return *value;
}

std::array<double, 3> take_vector(std::string_view& line, const MeshSource& source) {
  const double x = take_real(line, source);
  const double y = take_real(line, source);
  return {x, y, take_real(line, source)};
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, code] = std::from_chars(word.data(), end, value);
  if (code != std::errc() || rest != end) return std::nullopt;
  return value;
}

std::int32_t take_count(std::string_view& line, std::string_view what, const MeshSource& source) {
  const std::string_view word = take_word(line);
  const auto count = parse_integer(word);
  if (!count || *count < 0 || *count > std::numeric_limits<std::int32_t>::max()) {
    source.fail_in_line("has \"" + printable(word) + "\" as the number of " + std::string(what) +
                        "; it must be a whole number from 0 to 2147483647");
  }
  return static_cast<std::int32_t>(*count);
}

}  // namespace fathom
