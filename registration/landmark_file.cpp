#include "registration/landmark_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "acquisition/header_text.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/text_file.h"

namespace fathom {

namespace {

constexpr std::uintmax_t kLongestFile = 1'000'000;
constexpr std::size_t kMostLandmarks = 1000;
constexpr std::size_t kLongestName = 200;
constexpr double kFarthestMm = 1e6;

[[noreturn]] void fail(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  throw Error(path.string() + ": line " + std::to_string(line) + ": " + what);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  // One kind a line: beside semicolons a comma is a decimal one, and "12,5;0;0" must not be a place named 12.
  constexpr std::string_view kSeparators = ";\t,";
  const auto used = std::find_if(kSeparators.begin(), kSeparators.end(),
                                 [line](char c) { return line.find(c) != std::string_view::npos; });
  const char separator = used != kSeparators.end() ? *used : ',';
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find(separator);
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

std::string_view unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// "x,y,z" or "name,x,y,z", the units behind them perhaps: "x_mm".
bool is_heading(const std::vector<std::string_view>& cells) {
  constexpr std::array<char, 3> kAxes = {'x', 'y', 'z'};
  if (cells.size() < kAxes.size()) return false;
  const std::size_t first = cells.size() - kAxes.size();
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const std::string_view cell = unquoted(cells[first + i]);
    const bool named = !cell.empty() && (cell[0] == kAxes[i] || cell[0] == kAxes[i] - 'a' + 'A') && !parse_real(cell);
    if (!named) return false;
  }
  return true;
}

Landmark landmark_of(const std::vector<std::string_view>& cells, const std::filesystem::path& path, std::size_t line) {
  if (cells.size() != 3 && cells.size() != 4) {
    fail(path, line, "has " + std::to_string(cells.size()) + " values; give x,y,z or name,x,y,z");
  }
  Landmark landmark;
  const std::size_t first = cells.size() - 3;
  if (first == 1) {
    landmark.name = unquoted(cells[0]);
    const bool printable_name = std::none_of(landmark.name.begin(), landmark.name.end(),
                                             [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
    if (landmark.name.empty() || landmark.name.size() > kLongestName || !printable_name) {
      fail(path, line, "the name must have 1 to 200 bytes and no control characters; mend it");
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = parse_real(cells[first + i]);
    if (!value || std::abs(*value) > kFarthestMm) {
      fail(path, line,
           "'" + printable(cells[first + i]) + "' is no coordinate; give millimetres, with a decimal point");
    }
    landmark.position_mm[static_cast<Eigen::Index>(i)] = *value;
  }
  return landmark;
}

}  // namespace

std::vector<Landmark> read_landmarks(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, kLongestFile);
  std::string_view rest = text;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  std::vector<Landmark> landmarks;
  std::set<std::string> names;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    const std::string_view content = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (content.empty() || content.front() == '#') continue;
    const std::vector<std::string_view> cells = cells_of(content);
    if (landmarks.empty() && is_heading(cells)) continue;
    Landmark landmark = landmark_of(cells, path, line);
    if (!landmarks.empty() && landmark.name.empty() != landmarks.front().name.empty()) {
      fail(path, line, "some landmarks have names and some have none; name all or none");
    }
    if (!landmark.name.empty() && !names.insert(landmark.name).second) {
      fail(path, line, "'" + printable(landmark.name) + "' was there before; use each name once");
    }
    landmarks.push_back(std::move(landmark));
    if (landmarks.size() > kMostLandmarks) fail(path, line, "is one of more than 1000; give fewer landmarks");
  }
  if (landmarks.empty()) throw Error(path.string() + ": has no landmarks; give lines of x,y,z in millimetres");
  return landmarks;
}

}  // namespace fathom
