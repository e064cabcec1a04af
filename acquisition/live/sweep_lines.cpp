#include "acquisition/live/sweep_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <zlib.h>

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSeal = ",\"crc32\":\"";
constexpr std::size_t kSealBytes = kSeal.size() + 8 + 2;  // and the digits, and "}
constexpr std::size_t kLongestLine = 1 << 20;
constexpr std::array<std::pair<std::string_view, int>, 7> kPixelTypes = {{{"uint8", CV_8UC1},
                                                                          {"int8", CV_8SC1},
                                                                          {"uint16", CV_16UC1},
                                                                          {"int16", CV_16SC1},
                                                                          {"float32", CV_32FC1},
                                                                          {"float64", CV_64FC1},
                                                                          {"rgb8", CV_8UC3}}};

std::string hex(std::uint32_t value) {
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08x", value);
  return digits;
}

std::optional<std::uint32_t> parse_hex(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 8 || code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string sealed(const Json& json) {
  // Devices may send any bytes; a line is always JSON.
  std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  line.pop_back();
  line += kSeal;
  line += hex(crc32_of(0, line.data(), line.size() - kSeal.size()));
  line += "\"}\n";
  return line;
}

/// The object of a line whose checksum is right; empty where it is not.
std::optional<Json> unsealed(std::string_view line) {
  if (!is_whole_line(line)) return std::nullopt;
  Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

// NaN has no JSON.
Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json matrix_json(const Eigen::Matrix4d& matrix) {
  Json numbers = Json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(number_or_null(matrix(i / 4, i % 4)));
  return numbers;
}

Eigen::Matrix4d matrix_of(const Json& numbers) {
  if (numbers.size() != 16) throw std::out_of_range("a matrix has 16 numbers");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)].get<double>();
  return matrix;
}

// A whole number that is not negative: get() would make one of anything.
std::uint64_t count_of(const Json& value) {
  if (!value.is_number_unsigned()) throw std::out_of_range("not a count");
  return value.get<std::uint64_t>();
}

int small_count_of(const Json& value) {
  const std::uint64_t count = count_of(value);
  if (count > std::numeric_limits<int>::max()) throw std::out_of_range("not a small count");
  return static_cast<int>(count);
}

Json optional_json(const std::optional<double>& value) { return value ? number_or_null(*value) : Json(nullptr); }

std::optional<double> optional_of(const Json& value) {
  if (value.is_null()) return std::nullopt;
  return value.get<double>();
}

using Fields = std::vector<std::pair<std::string, std::string>>;

Json fields_json(const Fields& fields) {
  Json json = Json::array();
  for (const auto& [name, value] : fields) json.push_back({name, value});
  return json;
}

Fields fields_of(const Json& json) {
  Fields fields;
  for (const Json& field : json) {
    fields.emplace_back(field.at(0).get<std::string>(), field.at(1).get<std::string>());
  }
  return fields;
}

/// What `read` makes of a whole line; empty where the line is damaged or anything in it is missing or of another type.
template <typename Value, typename Read>
std::optional<Value> parse(std::string_view line, const char* kind, Read read) {
  const auto json = unsealed(line);
  if (!json || !json->contains(kind)) return std::nullopt;
  try {
    return read(*json);
  } catch (const std::exception&) {
    return std::nullopt;  // the library's own exceptions, of members that are not as they should be
  }
}

}  // namespace

std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(bytes), count));
}

std::string line_of(const SweepStart& start) {
  const auto type = std::find_if(kPixelTypes.begin(), kPixelTypes.end(),
                                 [&](const auto& known) { return known.second == start.pixel_type; });
  return sealed({{"fathom_sweep", 1},
                 {"width", start.width},
                 {"height", start.height},
                 {"pixel_type", type == kPixelTypes.end() ? "" : std::string(type->first)},
                 {"fields", fields_json(start.fields)}});
}

std::string line_of(const FrameLine& line) {
  const LiveFrame& frame = line.tracked.frame;
  Json poses = Json::object();
  for (const NamedPose& pose : line.tracked.poses) {
    poses[pose.transform] = {{"matrix", matrix_json(pose.pose.matrix)}, {"status", pose.pose.status}};
  }
  return sealed({{"frame", line.frame},
                 {"sweep", line.sweep},
                 {"time_s", number_or_null(frame.time_s)},
                 {"arrival_s", number_or_null(frame.arrival_s)},
                 {"device_time_s", optional_json(frame.device_time_s)},
                 {"number", frame.number},
                 {"offset", line.offset},
                 {"bytes", line.bytes},
                 {"pixels_crc32", hex(line.pixels_crc32)},
                 {"image_status", frame.status},
                 {"tracked", line.tracked.tracked},
                 {"poses", std::move(poses)},
                 {"fields", fields_json(frame.fields)}});
}

std::string line_of(const InvalidLine& invalid) { return sealed({{"invalid", {invalid.first, invalid.last}}}); }

std::string line_of(const GeometryLine& geometry) {
  return sealed({{"geometry_fault", geometry.fault}, {"since_s", number_or_null(geometry.since_s)}});
}

std::string line_of(const TrackerSample& sample) {
  return sealed({{"transform", sample.transform},
                 {"time_s", number_or_null(sample.time_s)},
                 {"arrival_s", number_or_null(sample.arrival_s)},
                 {"device_time_s", optional_json(sample.device_time_s)},
                 {"matrix", matrix_json(sample.pose.matrix)},
                 {"status", sample.pose.status}});
}

bool is_whole_line(std::string_view line) {
  if (line.size() <= kSealBytes) return false;
  const std::string_view seal = line.substr(line.size() - kSealBytes);
  const auto crc = parse_hex(seal.substr(kSeal.size(), 8));
  return seal.starts_with(kSeal) && seal.ends_with("\"}") && crc &&
         *crc == crc32_of(0, line.data(), line.size() - kSealBytes);
}

std::optional<SweepStart> parse_sweep_start(std::string_view line) {
  return parse<SweepStart>(line, "fathom_sweep", [](const Json& json) -> std::optional<SweepStart> {
    SweepStart start;
    start.width = small_count_of(json.at("width"));
    start.height = small_count_of(json.at("height"));
    const auto name = json.at("pixel_type").get<std::string>();
    const auto type =
        std::find_if(kPixelTypes.begin(), kPixelTypes.end(), [&](const auto& known) { return known.first == name; });
    if (json.at("fathom_sweep") != 1 || type == kPixelTypes.end()) return std::nullopt;
    start.pixel_type = type->second;
    start.fields = fields_of(json.at("fields"));
    return start;
  });
}

std::optional<FrameLine> parse_frame_line(std::string_view line) {
  return parse<FrameLine>(line, "frame", [](const Json& json) {
    FrameLine read;
    LiveFrame& frame = read.tracked.frame;
    read.frame = count_of(json.at("frame"));
    read.sweep = small_count_of(json.at("sweep"));
    frame.time_s = json.at("time_s").get<double>();
    frame.arrival_s = json.at("arrival_s").get<double>();
    frame.device_time_s = optional_of(json.at("device_time_s"));
    frame.number = count_of(json.at("number"));
    read.offset = count_of(json.at("offset"));
    read.bytes = count_of(json.at("bytes"));
    read.pixels_crc32 = parse_hex(json.at("pixels_crc32").get<std::string>()).value();
    frame.status = json.at("image_status").get<std::string>();
    read.tracked.tracked = json.at("tracked").get<bool>();
    for (const auto& [name, pose] : json.at("poses").items()) {
      read.tracked.poses.push_back({name, {matrix_of(pose.at("matrix")), pose.at("status").get<std::string>()}});
    }
    frame.fields = fields_of(json.at("fields"));
    return std::optional(read);
  });
}

std::optional<InvalidLine> parse_invalid_line(std::string_view line) {
  return parse<InvalidLine>(line, "invalid", [](const Json& json) {
    const Json& range = json.at("invalid");
    return std::optional(InvalidLine{count_of(range.at(0)), count_of(range.at(1))});
  });
}

std::optional<GeometryLine> parse_geometry_line(std::string_view line) {
  return parse<GeometryLine>(line, "geometry_fault", [](const Json& json) {
    return std::optional(GeometryLine{json.at("geometry_fault").get<std::string>(), json.at("since_s").get<double>()});
  });
}

std::optional<TrackerSample> parse_sample_line(std::string_view line) {
  return parse<TrackerSample>(line, "transform", [](const Json& json) {
    TrackerSample sample;
    sample.transform = json.at("transform").get<std::string>();
    sample.time_s = json.at("time_s").get<double>();
    sample.arrival_s = json.at("arrival_s").get<double>();
    sample.device_time_s = optional_of(json.at("device_time_s"));
    sample.pose = {matrix_of(json.at("matrix")), json.at("status").get<std::string>()};
    return std::optional(sample);
  });
}

void for_each_line(const InputFile& file, const std::function<void(std::string_view)>& use) {
  std::string held;
  bool too_long = false;
  std::vector<char> piece(1 << 17);
  for (std::uint64_t position = 0; position < file.size();) {
    const std::size_t count = file.read_some(position, std::as_writable_bytes(std::span(piece)));
    if (count == 0) return;
    position += count;
    std::string_view rest(piece.data(), count);
    for (std::size_t end; (end = rest.find('\n')) != std::string_view::npos; rest.remove_prefix(end + 1)) {
      held += rest.substr(0, end);
      use(too_long ? std::string_view() : std::string_view(held));
      held.clear();
      too_long = false;
    }
    held += rest;
    too_long = too_long || held.size() > kLongestLine;
    if (too_long) held.clear();
  }
}

}  // namespace fathom
