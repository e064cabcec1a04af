#include "acquisition/live/polhemus_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>
#include <vector>

namespace fathom {

namespace {

// Longer than any record: what has no end until here is no text.
constexpr std::size_t kLongestLine = 256;
// FASTRAK: header, 7 numbers of 13 characters (" 1.23456E+00 "), without the line's end.
constexpr std::size_t kFastrakLine = 3 + 7 * 13;

// The numbers of a line, which may touch where the next has a sign. Empty where anything else stands there.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    if (text.empty()) return numbers;
    if (text.front() == '+') text.remove_prefix(1);
    double number = 0.0;
    // Words such as "nan" are numbers here: the reading is then refused, not the line.
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc()) return std::nullopt;
    numbers.push_back(number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty() && text.front() != ' ' && text.front() != '-' && text.front() != '+') return std::nullopt;
  }
}

// A whole number that fits; numbers of the instrument's clock and counters are such.
template <typename Whole>
std::optional<Whole> whole(double number, double highest) {
  if (!(number >= 0.0 && number <= highest) || number != static_cast<double>(static_cast<std::uint64_t>(number))) {
    return std::nullopt;
  }
  return static_cast<Whole>(number);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Station and error of a line; the rest of it remains in `line`. Station 0 where it begins no record.
PolhemusReading take_header(std::string_view& line, const PolhemusFormat& format) {
  PolhemusReading reading;
  const bool fastrak = format.model == PolhemusModel::kFastrak;
  const std::size_t size = fastrak ? 3 : 4;
  if (line.size() <= size || !is_digit(line[0]) || !is_digit(line[1])) return reading;
  if (!fastrak && line[2] != ' ' && line[2] != 'P' && line[2] != 'C') return reading;
  const int station = 10 * (line[0] - '0') + (line[1] - '0');
  const auto error = static_cast<unsigned char>(line[size - 1]);
  if (station > most_stations(format.model) || (error != ' ' && !std::isalpha(error))) return reading;
  reading.station = station;
  reading.error = error == ' ' ? 0 : error;
  line.remove_prefix(size);
  return reading;
}

std::optional<PolhemusReading> read_line(std::string_view line, const PolhemusFormat& format) {
  const bool fastrak = format.model == PolhemusModel::kFastrak;
  if (fastrak && line.size() != kFastrakLine) return std::nullopt;
  PolhemusReading reading = take_header(line, format);
  const auto numbers = numbers_of(line);
  const std::size_t before = fastrak ? 0 : format.distortion ? 3 : 2;
  if (reading.station == 0 || !numbers || numbers->size() != before + 7) return std::nullopt;
  const double* next = numbers->data();
  if (!fastrak) {
    reading.time_ms = whole<std::uint32_t>(*next++, 4294967295.0);
    reading.frame = whole<std::uint32_t>(*next++, 4294967295.0);
    if (!reading.time_ms || !reading.frame) return std::nullopt;
    if (format.distortion) {
      reading.distortion = whole<int>(*next++, 2147483647.0);
      if (!reading.distortion) return std::nullopt;
    }
  }
  for (int i = 0; i < 3; ++i) reading.position_mm[i] = format.unit_mm * *next++;
  for (int i = 0; i < 4; ++i) reading.quaternion[i] = *next++;
  return reading;
}

}  // namespace

PolhemusStep read_polhemus_line(std::span<const std::uint8_t> bytes, const PolhemusFormat& format) {
  const auto end = std::find(bytes.begin(), bytes.end(), '\n');
  const auto length = static_cast<std::size_t>(end - bytes.begin());
  if (end == bytes.end()) return {length > kLongestLine ? length : 0, {}};
  std::string_view line(reinterpret_cast<const char*>(bytes.data()), length);
  if (!line.ends_with('\r')) return {length + 1, {}};  // lines end with both
  line.remove_suffix(1);
  return {length + 1, read_line(line, format)};
}

}  // namespace fathom
