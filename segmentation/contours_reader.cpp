#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/json.h"
#include "segmentation/contour_entries.h"
#include "segmentation/contours.h"

namespace fathom {

namespace {

constexpr std::size_t kMostPoints = 1'000'000;  // in one contour
constexpr double kFarthest = 1e6;               // pixels

Eigen::Vector2d read_point(const JsonValue& value) {
  if (value.size() != 2) value.fail("must be a point: two numbers, x and y");
  const Eigen::Vector2d point(value[0].number(), value[1].number());
  if (point.cwiseAbs().maxCoeff() > kFarthest) value.fail("lies more than a million pixels away; give pixels");
  return point;
}

Polygon read_points(const JsonValue& value) {
  const std::size_t count = value.size();
  if (count < 3) {
    value.fail("has " + std::to_string(count) + " points, but an outline needs at least three; draw it again");
  }
  if (count > kMostPoints) value.fail("has more than a million points; thin them out");
  Polygon points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) points.push_back(read_point(value[i]));
  return points;
}

int read_index(const JsonValue& value) { return value.integer(0, std::numeric_limits<int>::max()); }

}  // namespace

void read_entry(const JsonValue& value, Structure& structure) {
  const int frame = read_index(value.at("frame"));
  const int recording = value.has("recording") ? read_index(value.at("recording")) : 0;
  const bool absent = value.has("absent") && value.at("absent").boolean();
  if (absent + value.has("point") + value.has("points") != 1) {
    value.fail("must have one of \"points\" (an outline), \"point\" (an extremity) and \"absent\": true");
  }
  if (absent) {
    structure.absent.push_back({frame, recording});
  } else if (value.has("point")) {
    structure.extremities.push_back({frame, read_point(value.at("point")), recording});
  } else {
    Contour contour;
    contour.frame = frame;
    contour.recording = recording;
    contour.points_px = read_points(value.at("points"));
    if (value.has("closed")) contour.closed = value.at("closed").boolean();
    if (value.has("confidence") && !value.at("confidence").is_null()) {
      contour.confidence = value.at("confidence").number();
      if (*contour.confidence < 0.0 || *contour.confidence > 1.0) {
        value.at("confidence").fail("must lie between 0 and 1");
      }
    }
    structure.contours.push_back(std::move(contour));
  }
}

namespace {

// A frame is outlined, or an extremity, or without the structure; two of these contradict each other.
void require_consistent(const JsonValue& value, const Structure& structure) {
  std::set<std::pair<int, int>> outlined;
  for (const Contour& contour : structure.contours) outlined.insert({contour.recording, contour.frame});
  std::set<std::pair<int, int>> seen = outlined;
  for (const Extremity& extremity : structure.extremities) {
    if (!seen.insert({extremity.recording, extremity.frame}).second) {
      value.fail("frame " + std::to_string(extremity.frame) +
                 " is an extremity and has something else too; keep one of them");
    }
  }
  for (const AbsentMark& mark : structure.absent) {
    if (seen.count({mark.recording, mark.frame}) > 0) {
      value.fail("frame " + std::to_string(mark.frame) + " is outlined, but also marked as absent; keep one of them");
    }
  }
}

std::string read_name(const JsonValue& value) {
  const std::string name = value.string();
  if (const auto fault = name_fault(name)) value.fail(*fault);
  return name;
}

}  // namespace

std::string read_color(const JsonValue& value) {
  const std::string color = value.string();
  const auto hexadecimal = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  if (color.size() != 7 || color[0] != '#' || !std::all_of(color.begin() + 1, color.end(), hexadecimal)) {
    value.fail("must be a colour such as \"#33ccff\"");
  }
  return color;
}

double read_opacity(const JsonValue& value) {
  const double opacity = value.number();
  if (!(opacity >= 0.0 && opacity <= 1.0)) value.fail("must be a number from 0, not seen, to 1, solid");
  return opacity;
}

Structure read_structure(const JsonValue& value) {
  Structure structure;
  structure.name = read_name(value.at("name"));
  if (value.has("color")) structure.color = read_color(value.at("color"));
  if (value.has("opacity")) structure.opacity = read_opacity(value.at("opacity"));
  const JsonValue contours = value.at("contours");
  for (std::size_t i = 0; i < contours.size(); ++i) read_entry(contours[i], structure);
  require_consistent(contours, structure);
  return structure;
}

std::vector<Structure> read_contours(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, "fathom_contours", 1);
  const JsonValue list = root.at("structures");
  std::vector<Structure> structures;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    structures.push_back(read_structure(list[i]));
    if (!names.insert(structures.back().name).second) {
      list[i].at("name").fail("is the name of an earlier structure too; give each its own");
    }
  }
  return structures;
}

}  // namespace fathom
