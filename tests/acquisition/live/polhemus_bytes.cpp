#include "tests/acquisition/live/polhemus_bytes.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <numeric>

namespace fathom {

namespace {

void append_word(std::string& bytes, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xff);
}

std::vector<double> numbers_of(const PolhemusReading& reading, const PolhemusFormat& format) {
  const Eigen::Vector3d position = reading.position_mm / format.unit_mm;
  std::vector<double> numbers(position.begin(), position.end());
  numbers.insert(numbers.end(), reading.quaternion.begin(), reading.quaternion.end());
  return numbers;
}

std::string text_line(const PolhemusReading& reading, const PolhemusFormat& format) {
  const bool fastrak = format.model == PolhemusModel::kFastrak;
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, fastrak ? "%02d%c" : "%02d %c", reading.station,
                reading.error == 0 ? ' ' : reading.error);
  std::string line = buffer;
  if (!fastrak) {
    std::snprintf(buffer, sizeof buffer, "%10u %10u ", *reading.time_ms, *reading.frame);
    line += buffer;
    if (format.distortion) line += std::to_string(*reading.distortion) + ' ';
  }
  for (const double number : numbers_of(reading, format)) {
    std::snprintf(buffer, sizeof buffer, fastrak ? "% 12.5E " : "% 9.4f", number);
    line += buffer;
  }
  return line + "\r\n";
}

std::string binary_record(const PolhemusReading& reading, const PolhemusFormat& format) {
  const bool fastrak = format.model == PolhemusModel::kFastrak;
  const auto station = static_cast<char>(reading.station);
  const auto error = static_cast<char>(reading.error == 0 ? ' ' : reading.error);
  std::string bytes;
  if (fastrak) {
    bytes = {'0', static_cast<char>('0' + station), error};
  } else {
    bytes = format.model == PolhemusModel::kPatriot ? "PA" : "LY";
    bytes += {station, 'C', error, 0, static_cast<char>(8 + (format.distortion ? 4 : 0) + 28 + 1), 0};
    append_word(bytes, *reading.time_ms);
    append_word(bytes, *reading.frame);
    if (format.distortion) append_word(bytes, static_cast<std::uint32_t>(*reading.distortion));
  }
  for (const double number : numbers_of(reading, format)) {
    append_word(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(number)));
  }
  return bytes + (fastrak ? "\r\n" : " ");
}

}  // namespace

std::string polhemus_bytes(const PolhemusReading& reading, const PolhemusFormat& format) {
  return format.text ? text_line(reading, format) : binary_record(reading, format);
}

PolhemusReading random_reading(Random& random, int station, std::uint32_t frame) {
  PolhemusReading reading;
  reading.station = station;
  reading.position_mm =
      Eigen::Vector3d(random.uniform(-500, 500), random.uniform(-500, 500), random.uniform(-500, 500));
  reading.quaternion = Eigen::Vector4d(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
  reading.time_ms = 1000 + frame * 8;
  reading.frame = frame;
  reading.distortion = 0;
  return reading;
}

PolhemusFound find_all(const std::string& bytes, const PolhemusFormat& format, std::size_t piece) {
  PolhemusFound found;
  std::vector<std::uint8_t> waiting;
  for (std::size_t from = 0; from < bytes.size(); from += piece) {
    const std::string part = bytes.substr(from, piece);
    waiting.insert(waiting.end(), part.begin(), part.end());
    std::size_t used = 0;
    while (true) {
      const PolhemusStep step = read_polhemus(std::span(waiting).subspan(used), format);
      if (step.used == 0) break;
      used += step.used;
      if (step.reading) {
        found.readings.push_back(*step.reading);
      } else {
        found.noise += step.used;
      }
    }
    waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(used));
  }
  found.left = waiting.size();
  return found;
}

}  // namespace fathom
