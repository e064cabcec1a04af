#include "registration/plus_xml.h"

#include <tinyxml2.h>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

// All sections that hold transforms lie directly under the document's root.
constexpr const char* kSections[] = {"CoordinateDefinitions", "CalibrationResults"};

// The parser compares every attribute of an element with all before it: a million of them would take for ever.
constexpr int kMostQuotes = 2000;  // two an attribute; PLUS writes a dozen attributes

void require_moderate(const std::string& xml, const std::string& file) {
  int quotes = 0;
  for (const char c : xml) {
    if (c == '<' || c == '>') quotes = 0;
    if ((c == '"' || c == '\'') && ++quotes > kMostQuotes) {
      throw Error(file + ": has an XML element of very many attributes; check that it is the right file");
    }
  }
}

Eigen::Matrix4d matrix_of(const tinyxml2::XMLElement& transform, const std::string& what) {
  const char* text = transform.Attribute("Matrix");
  if (text == nullptr) throw Error(what + " has no Matrix; check the file");
  const auto values = parse_reals(text);
  if (!values || values->size() != 16) throw Error(what + " must have 16 finite numbers; check the file");
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values->data());
}

}  // namespace

const tinyxml2::XMLElement& parse_plus_xml(tinyxml2::XMLDocument& document, const std::string& xml,
                                           const std::string& file) {
  require_moderate(xml, file);
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    throw Error(file + ": is not valid XML (line " + std::to_string(document.ErrorLineNum()) +
                "); check that the file is complete");
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr) throw Error(file + ": is XML without any element; check that it is the right file");
  return *root;
}

std::optional<Eigen::Matrix4d> plus_transform(const std::string& xml, const std::string& from, const std::string& to,
                                              const std::string& file) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& root = parse_plus_xml(document, xml, file);
  const std::string what = file + ": the transform from " + from + " to " + to;
  std::optional<Eigen::Matrix4d> found;
  for (const char* name : kSections) {
    for (auto* section = root.FirstChildElement(name); section; section = section->NextSiblingElement(name)) {
      for (auto* transform = section->FirstChildElement("Transform"); transform;
           transform = transform->NextSiblingElement("Transform")) {
        if (!transform->Attribute("From", from.c_str()) || !transform->Attribute("To", to.c_str())) continue;
        const Eigen::Matrix4d matrix = matrix_of(*transform, what);
        if (found && *found != matrix) throw Error(what + " stands there twice, differently; remove the wrong one");
        found = matrix;
      }
    }
  }
  return found;
}

}  // namespace fathom
