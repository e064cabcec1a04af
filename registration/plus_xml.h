#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace fathom {

/// Parses a PLUS configuration into `document` and returns its root element. `file` is for messages. Throws Error when
/// the XML is damaged, has no element, or has an element of very many attributes.
const tinyxml2::XMLElement& parse_plus_xml(tinyxml2::XMLDocument& document, const std::string& xml,
                                           const std::string& file);

/// The 4x4 matrix of the transform `from` -> `to` in a PLUS configuration or result file, given as its text. Only
/// `Transform` elements directly under a `CoordinateDefinitions` or `CalibrationResults` count. `file` is for
/// messages. Empty where there is none. Throws Error when the XML is damaged, or when the transform stands twice with
/// different numbers or has not 16 finite numbers.
std::optional<Eigen::Matrix4d> plus_transform(const std::string& xml, const std::string& from, const std::string& to,
                                              const std::string& file);

}  // namespace fathom
