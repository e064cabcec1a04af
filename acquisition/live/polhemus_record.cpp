#include "acquisition/live/polhemus_record.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string_view>

#include <Eigen/Geometry>

#include "acquisition/live/polhemus_text.h"
#include "acquisition/rigid.h"

namespace fathom {

namespace {

using Bytes = std::span<const std::uint8_t>;

struct Model {
  const char* name;
  int stations;
  char preamble[2];
};

constexpr Model kModels[] = {{"FASTRAK", 4, {'0', 0}}, {"PATRIOT", 2, {'P', 'A'}}, {"LIBERTY", 16, {'L', 'Y'}}};

const Model& model_of(PolhemusModel model) { return kModels[static_cast<int>(model)]; }

constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kFastrakBytes = 3 + 7 * 4 + 2;
// The sources reach 2 to 5 m: farther away a number was altered on the line.
constexpr double kFarthest_mm = 10'000.0;

std::uint32_t word_at(Bytes bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | bytes[at + i];
  return word;
}

// Position and quaternion.
void read_floats(Bytes bytes, std::size_t at, double unit_mm, PolhemusReading& reading) {
  std::array<double, 7> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::bit_cast<float>(word_at(bytes, at + 4 * i));
  reading.position_mm = unit_mm * Eigen::Vector3d(values[0], values[1], values[2]);
  reading.quaternion = Eigen::Vector4d(values[3], values[4], values[5], values[6]);
}

bool is_unit(const Eigen::Vector4d& q) {
  // The matrix of a quaternion of length n is n^2 times a rotation, whose R^T R is off by n^4 - 1.
  const double square = q.squaredNorm();
  return std::abs(square * square - 1.0) <= 1e-3;  // false for NaN
}

bool is_blank(int error) { return error == 0 || error == ' '; }

std::size_t tagged_bytes(const PolhemusFormat& format) {
  return kHeaderBytes + 8 + (format.distortion ? 4 : 0) + 7 * 4 + 1;
}

// Whether `bytes` may begin a record, as far as they go.
bool begins_tagged(Bytes bytes, const PolhemusFormat& format) {
  const Model& model = model_of(format.model);
  const std::size_t size = tagged_bytes(format) - kHeaderBytes;
  for (std::size_t i = 0; i < std::min(bytes.size(), kHeaderBytes); ++i) {
    const int byte = bytes[i];
    const bool fits = i < 2    ? byte == model.preamble[i]
                      : i == 2 ? byte >= 1 && byte <= model.stations
                      : i == 3 ? byte == 'P' || byte == 'C'
                      : i < 6  ? true
                      : i == 6 ? byte == static_cast<int>(size)
                               : byte == 0;
    if (!fits) return false;
  }
  return true;
}

PolhemusReading read_tagged(Bytes bytes, const PolhemusFormat& format) {
  PolhemusReading reading;
  reading.station = bytes[2];
  reading.error = is_blank(bytes[4]) ? 0 : bytes[4];
  reading.time_ms = word_at(bytes, kHeaderBytes);
  reading.frame = word_at(bytes, kHeaderBytes + 4);
  if (format.distortion) reading.distortion = static_cast<int>(word_at(bytes, kHeaderBytes + 8));
  read_floats(bytes, kHeaderBytes + (format.distortion ? 12 : 8), format.unit_mm, reading);
  return reading;
}

bool begins_fastrak(Bytes bytes, const PolhemusFormat& format) {
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 3); ++i) {
    const int byte = bytes[i];
    const bool fits = i == 0   ? byte == '0'
                      : i == 1 ? byte >= '1' && byte < '1' + model_of(format.model).stations
                               : byte == ' ' || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z');
    if (!fits) return false;
  }
  return true;
}

PolhemusReading read_fastrak(Bytes bytes, const PolhemusFormat& format) {
  PolhemusReading reading;
  reading.station = bytes[1] - '0';
  reading.error = is_blank(bytes[2]) ? 0 : bytes[2];
  read_floats(bytes, 3, format.unit_mm, reading);
  return reading;
}

// How binary records of a family are told and read.
struct Layout {
  bool (*begins)(Bytes, const PolhemusFormat&);
  PolhemusReading (*read)(Bytes, const PolhemusFormat&);
  std::size_t size;
  std::string_view end;
};

PolhemusStep read_binary(Bytes bytes, const PolhemusFormat& format, const Layout& layout) {
  std::size_t noise = 0;
  while (noise < bytes.size() && !layout.begins(bytes.subspan(noise), format)) ++noise;
  if (noise > 0) return {noise, {}};
  if (bytes.size() < layout.size) return {};
  const Bytes record = bytes.first(layout.size);
  const Bytes end = record.last(layout.end.size());
  if (!std::equal(end.begin(), end.end(), layout.end.begin())) return {1, {}};
  const PolhemusReading reading = layout.read(record, format);
  // A record that was cut may by chance end as it should, inside of the next: that one is not to be lost with it.
  if (!is_unit(reading.quaternion)) {
    for (std::size_t i = 1; i + 4 < record.size(); ++i) {
      if (layout.begins(bytes.subspan(i), format)) return {i, {}};
    }
  }
  return {layout.size, reading};
}

// What an error of the instrument means where that is more than a fault of its own. PATRIOT and LIBERTY state it as a
// letter or as a number of their list of errors.
struct ErrorName {
  int code;
  const char* status;
};
constexpr ErrorName kErrorNames[] = {{'u', "OUT_OF_VOLUME"}, {49, "OUT_OF_VOLUME"}, {'x', "OUT_OF_VOLUME"}};

std::string status_of_error(int error) {
  for (const ErrorName& known : kErrorNames) {
    if (known.code == error) return known.status;
  }
  const bool letter = (error >= 'A' && error <= 'Z') || (error >= 'a' && error <= 'z');
  return "INSTRUMENT_ERROR_" + (letter ? std::string(1, static_cast<char>(error)) : std::to_string(error));
}

std::string status_of(const PolhemusReading& reading, int most_distortion) {
  if (!is_blank(reading.error)) return status_of_error(reading.error);
  if (!reading.position_mm.allFinite() || !reading.quaternion.allFinite()) return "NOT_FINITE";
  if (!is_unit(reading.quaternion)) return "NOT_RIGID";
  if (reading.position_mm.norm() > kFarthest_mm) return "OUT_OF_VOLUME";
  if (reading.distortion && (*reading.distortion < 0 || *reading.distortion > most_distortion)) return "DISTORTED";
  return "OK";
}

}  // namespace

const char* name_of(PolhemusModel model) { return model_of(model).name; }

int most_stations(PolhemusModel model) { return model_of(model).stations; }

PolhemusStep read_polhemus(std::span<const std::uint8_t> bytes, const PolhemusFormat& format) {
  if (bytes.empty()) return {};
  if (format.text) return read_polhemus_line(bytes, format);
  if (format.model == PolhemusModel::kFastrak) {
    return read_binary(bytes, format, {begins_fastrak, read_fastrak, kFastrakBytes, "\r\n"});
  }
  return read_binary(bytes, format, {begins_tagged, read_tagged, tagged_bytes(format), " "});
}

Pose polhemus_pose(const PolhemusReading& reading, int most_distortion) {
  Pose pose;
  pose.status = status_of(reading, most_distortion);
  if (!reading.position_mm.allFinite() || !is_unit(reading.quaternion)) return pose;
  const Eigen::Vector4d& q = reading.quaternion;
  pose.matrix.topLeftCorner<3, 3>() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  pose.matrix.topRightCorner<3, 1>() = reading.position_mm;
  return pose;
}

}  // namespace fathom
