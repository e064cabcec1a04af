#include "acquisition/header_text.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "core/input_file.h"
#include "core/numbers.h"

namespace fathom {

namespace {

constexpr std::size_t kLongestLine = 1 << 20;           // no field is that long; rubbish without line ends may be
constexpr std::size_t kReadBytes = 1 << 17;             // at a time: most headers need no more
constexpr std::uint64_t kLongestHeader = 512ull << 20;  // about a million frames with three transforms each

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  while (!(text = trimmed(text)).empty()) {
    const auto end = static_cast<std::size_t>(std::find_if(text.begin(), text.end(), is_blank) - text.begin());
    result.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return result;
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc() || rest != end) return std::nullopt;
  return value;
}

bool parse_reals(std::string_view text, std::span<double> out) {
  for (double& value : out) {
    text = trimmed(text);
    const auto end = static_cast<std::size_t>(std::find_if(text.begin(), text.end(), is_blank) - text.begin());
    const auto number = parse_real(text.substr(0, end));
    if (!number) return false;
    value = *number;
    text.remove_prefix(end);
  }
  return trimmed(text).empty();
}

HeaderLines::HeaderLines(const InputFile& file)
    : file_(file), buffer_(std::make_unique_for_overwrite<char[]>(kLongestLine)) {}

std::optional<std::string_view> HeaderLines::next() {
  const auto find_end = [&](std::size_t from) {
    return static_cast<const char*>(std::memchr(buffer_.get() + from, '\n', end_ - from));
  };
  const char* line_end = find_end(begin_);
  if (line_end == nullptr) {
    std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
    buffer_position_ += begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  while (line_end == nullptr && end_ < kLongestLine) {
    const std::size_t had = end_;
    const auto room = std::span(buffer_.get() + end_, std::min(kReadBytes, kLongestLine - end_));
    end_ += file_.read_some(buffer_position_ + end_, std::as_writable_bytes(room));
    if (end_ == had) break;
    line_end = find_end(had);
  }
  if (begin_ == end_) return std::nullopt;
  ++line_number_;
  line_was_ended_ = line_end != nullptr;
  if (!line_was_ended_ && end_ == kLongestLine)
    fail("is too long for a header; this is no recording, or a damaged one");
  const char* const begin = buffer_.get() + begin_;
  const auto length = static_cast<std::size_t>((line_was_ended_ ? line_end : buffer_.get() + end_) - begin);
  begin_ += length + (line_was_ended_ ? 1 : 0);
  if (position() > kLongestHeader) file_.fail("its header is longer than 512 MB; split the recording");
  std::string_view line(begin, length);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

void HeaderLines::fail(const std::string& what) const {
  file_.fail("line " + std::to_string(line_number_) + " " + what);
}

}  // namespace fathom
