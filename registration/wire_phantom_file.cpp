#include "registration/wire_phantom_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>
#include <tinyxml2.h>

#include "acquisition/rigid.h"
#include "core/error.h"
#include "core/json.h"
#include "core/numbers.h"
#include "core/printable.h"
#include "core/text_file.h"
#include "registration/plus_xml.h"

namespace fathom {

namespace {

constexpr std::uintmax_t kMaxBytes = 8u << 20;  // as for calibrations, which may stand in the same file
constexpr std::size_t kMostPatterns = 100;      // an image shows a dozen
constexpr double kMinWireMm = 2.0;              // shorter: metres were meant
constexpr double kMaxWireMm = 2000.0;           // longer: micrometres were
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMaxOuterAngle = 1.0 * kDegree;   // of outer wires: farther from parallel, the ratio rule is wrong
constexpr double kMinMiddleAngle = 3.0 * kDegree;  // of the middle wire to them: nearer, it tells no position
constexpr double kMaxOffPlaneMm = 0.5;             // of wires of one pattern: plates are drilled better than that

void check_wire(const Wire& wire, const std::string& what) {
  const double length = (wire.back - wire.front).norm();
  if (!wire.front.allFinite() || !wire.back.allFinite()) throw Error(what + " has an end that is not finite");
  if (length < kMinWireMm || length > kMaxWireMm) {
    throw Error(what + " is " + format_real(length) + " mm long, which no phantom's is; ends must be in millimetres");
  }
}

// Where the wire of one pattern lies across the others: along the direction in their plane that is across the outer.
void check_pattern(const NPattern& pattern, const std::string& what) {
  for (const Wire& wire : pattern) check_wire(wire, what + ": the wire " + printable(wire.name));
  Eigen::Vector3d along = (pattern[0].back - pattern[0].front).normalized();
  const Eigen::Vector3d third = (pattern[2].back - pattern[2].front).normalized();
  if (along.cross(third).norm() > std::sin(kMaxOuterAngle) || along.dot(third) < 0.0) {
    throw Error(what +
                ": its first and third wire are not parallel; list the wires as outer, middle, outer, each with "
                "its front end first");
  }
  along = (along + third).normalized();
  const Eigen::Vector3d apart = pattern[2].front - pattern[0].front;
  const Eigen::Vector3d sideways = apart - along * along.dot(apart);
  const double width = sideways.norm();
  if (width < kMinWireMm) {
    throw Error(what + ": its first and third wire are " + format_real(width) +
                " mm apart; two wires are the same, or ends are not in millimetres");
  }
  const Eigen::Vector3d across = sideways / width;
  const Eigen::Vector3d normal = along.cross(across);
  const auto share_across = [&](const Eigen::Vector3d& point) { return across.dot(point - pattern[0].front) / width; };
  for (const Eigen::Vector3d& end : {pattern[1].front, pattern[1].back}) {
    if (std::abs(normal.dot(end - pattern[0].front)) > kMaxOffPlaneMm) {
      throw Error(what + ": its three wires do not lie in one plane; check their ends");
    }
    if (share_across(end) < -1e-6 || share_across(end) > 1.0 + 1e-6) {
      throw Error(what +
                  ": its middle wire crosses an outer one or lies outside; list the wires as outer, middle, "
                  "outer");
    }
  }
  const Eigen::Vector3d middle = (pattern[1].back - pattern[1].front).normalized();
  if (std::abs(middle.dot(across)) < std::sin(kMinMiddleAngle)) {
    throw Error(what + ": its middle wire is parallel to the outer ones, so it tells no position; check its ends");
  }
}

void check_phantom(const WirePhantom& phantom, const std::string& file) {
  if (phantom.patterns.empty()) throw Error(file + ": has no N-shaped pattern of wires; give an N-wire phantom's file");
  if (phantom.patterns.size() > kMostPatterns) throw Error(file + ": has more than 100 patterns; check the file");
  std::vector<const Wire*> wires;
  for (std::size_t i = 0; i < phantom.patterns.size(); ++i) {
    check_pattern(phantom.patterns[i], file + ": pattern " + std::to_string(i + 1));
    for (const Wire& wire : phantom.patterns[i]) wires.push_back(&wire);
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < wires.size(); ++i) {
    if (!names.insert(wires[i]->name).second) {
      throw Error(file + ": two wires are called \"" + printable(wires[i]->name) + "\"; give each its own name");
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double apart =
          std::max((wires[i]->front - wires[j]->front).norm(), (wires[i]->back - wires[j]->back).norm());
      if (apart < 1e-3) {
        throw Error(file + ": the wires " + printable(wires[j]->name) + " and " + printable(wires[i]->name) +
                    " are the same line; check their ends");
      }
    }
  }
}

Eigen::Isometry3d checked_registration(const Eigen::Matrix4d& matrix, const std::string& file) {
  if (!matrix.allFinite() || !is_rigid(matrix) || !matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9)) {
    throw Error(file +
                ": the transform from the phantom to the reference is not a rigid motion; register the phantom "
                "again, or remove it so that it is estimated");
  }
  return nearest_rigid(matrix);
}

Eigen::Vector3d point_of(const tinyxml2::XMLElement& wire, const char* attribute, const std::string& what) {
  const char* text = wire.Attribute(attribute);
  const auto values = text ? parse_reals(text) : std::nullopt;
  if (!values || values->size() != 3) throw Error(what + " must have an " + attribute + " of three numbers");
  return {(*values)[0], (*values)[1], (*values)[2]};
}

NPattern pattern_of(const tinyxml2::XMLElement& element, const std::string& what) {
  const char* type = element.Attribute("Type");
  if (type == nullptr || std::string_view(type) != "NWire") {
    throw Error(what + " is of type " + (type ? printable(type) : "unknown") +
                "; only N-shaped patterns (Type=\"NWire\") can be used, remove the others");
  }
  NPattern pattern;
  std::size_t count = 0;
  for (auto* wire = element.FirstChildElement("Wire"); wire; wire = wire->NextSiblingElement("Wire"), ++count) {
    if (count >= pattern.size()) continue;
    const std::string here = what + ": wire " + std::to_string(count + 1);
    const char* name = wire->Attribute("Name");
    if (name == nullptr) throw Error(here + " has no Name");
    pattern[count] = {name, point_of(*wire, "EndPointFront", here), point_of(*wire, "EndPointBack", here)};
  }
  if (count != pattern.size()) throw Error(what + " has " + std::to_string(count) + " wires; an N has three");
  return pattern;
}

WirePhantom from_plus_xml(const std::string& text, const std::string& file,
                          const std::optional<std::string>& reference_frame) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& root = parse_plus_xml(document, text, file);
  const tinyxml2::XMLElement* definition =
      std::strcmp(root.Name(), "PhantomDefinition") == 0 ? &root : root.FirstChildElement("PhantomDefinition");
  if (definition == nullptr) {
    throw Error(file + ": has no PhantomDefinition; give the PLUS configuration that describes the phantom");
  }
  WirePhantom phantom;
  if (const auto* description = definition->FirstChildElement("Description")) {
    if (const char* name = description->Attribute("Name")) phantom.name = name;
  }
  if (const auto* geometry = definition->FirstChildElement("Geometry")) {
    for (auto* element = geometry->FirstChildElement("Pattern"); element;
         element = element->NextSiblingElement("Pattern")) {
      phantom.patterns.push_back(
          pattern_of(*element, file + ": pattern " + std::to_string(phantom.patterns.size() + 1)));
      if (phantom.patterns.size() > kMostPatterns) break;
    }
  }
  auto matrix = plus_transform(text, "Phantom", reference_frame.value_or("Reference"), file);
  if (!matrix && reference_frame) matrix = plus_transform(text, "Phantom", "Reference", file);
  if (matrix) phantom.reference_from_phantom = checked_registration(*matrix, file);
  return phantom;
}

Eigen::Vector3d point_of(const JsonValue& value) {
  if (value.size() != 3) value.fail("must have three numbers");
  return {value[0].number(), value[1].number(), value[2].number()};
}

WirePhantom from_json(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, "fathom_phantom", 1);
  WirePhantom phantom;
  if (root.has("name")) phantom.name = root.at("name").string();
  const JsonValue patterns = root.at("patterns");
  for (std::size_t i = 0; i < std::min(patterns.size(), kMostPatterns + 1); ++i) {
    const JsonValue wires = patterns[i].at("wires");
    NPattern pattern;
    if (wires.size() != pattern.size()) wires.fail("must be the three wires of an N");
    for (std::size_t w = 0; w < pattern.size(); ++w) {
      pattern[w] = {wires[w].at("name").string(), point_of(wires[w].at("front")), point_of(wires[w].at("back"))};
    }
    phantom.patterns.push_back(std::move(pattern));
  }
  if (root.has("phantom_to_reference") && !root.at("phantom_to_reference").is_null()) {
    const JsonValue numbers = root.at("phantom_to_reference");
    if (numbers.size() != 16) numbers.fail("must have 16 numbers, a 4x4 matrix row by row");
    Eigen::Matrix4d matrix;
    for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)].number();
    phantom.reference_from_phantom = checked_registration(matrix, path.string());
  }
  return phantom;
}

}  // namespace

WirePhantom read_wire_phantom(const std::filesystem::path& path, const std::optional<std::string>& reference_frame) {
  const std::string text = read_text_file(path, kMaxBytes);
  const std::size_t start = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (start == std::string::npos) throw Error(path.string() + ": is empty; give a phantom's file");
  WirePhantom phantom = text[start] == '<' ? from_plus_xml(text, path.string(), reference_frame) : from_json(path);
  check_phantom(phantom, path.string());
  return phantom;
}

std::string wire_phantom_json(const WirePhantom& phantom) {
  const auto numbers = [](const Eigen::Vector3d& point) {
    return nlohmann::ordered_json{point.x(), point.y(), point.z()};
  };
  nlohmann::ordered_json json;
  json["fathom_phantom"] = 1;
  json["name"] = phantom.name;
  auto& patterns = json["patterns"] = nlohmann::ordered_json::array();
  for (const NPattern& pattern : phantom.patterns) {
    auto wires = nlohmann::ordered_json::array();
    for (const Wire& wire : pattern) {
      wires.push_back({{"name", wire.name}, {"front", numbers(wire.front)}, {"back", numbers(wire.back)}});
    }
    patterns.push_back({{"wires", std::move(wires)}});
  }
  if (phantom.reference_from_phantom) {
    auto& matrix = json["phantom_to_reference"] = nlohmann::ordered_json::array();
    for (int i = 0; i < 16; ++i) matrix.push_back(phantom.reference_from_phantom->matrix()(i / 4, i % 4));
  }
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
