#include "exam/edit_json.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/json.h"
#include "core/numbers.h"
#include "registration/dividing_planes.h"
#include "segmentation/contour_entries.h"

namespace fathom {

namespace {

constexpr int kMostIndices = std::numeric_limits<int>::max();
constexpr std::array<const char*, kExamTexts> kTexts{"patient", "operator", "date", "notes"};

template <typename Item>
struct Kind;
template <>
struct Kind<Contour> {
  static constexpr const char* key = "contour";
  static constexpr std::vector<Contour> Structure::*list = &Structure::contours;
};
template <>
struct Kind<Extremity> {
  static constexpr const char* key = "extremity";
  static constexpr std::vector<Extremity> Structure::*list = &Structure::extremities;
};
template <>
struct Kind<AbsentMark> {
  static constexpr const char* key = "absent";
  static constexpr std::vector<AbsentMark> Structure::*list = &Structure::absent;
};

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string number(std::size_t value) { return std::to_string(value); }

std::string value_json(const Structure& structure) { return structure_json(structure, ""); }
template <typename Item>
std::string value_json(const Item& item) {
  return entry_json(item);
}

template <typename Value>
std::string value_json(const std::optional<Value>& value) {
  return value ? value_json(*value) : "null";
}

std::string before_and_after(const std::string& before, const std::string& after) {
  return ", \"before\": " + before + ", \"after\": " + after + "}";
}

template <typename Item>
std::string change_json(const ItemChange<Item>& change) {
  return "{\"structure\": " + number(change.structure) + ", \"" + Kind<Item>::key + "\": " + number(change.index) +
         before_and_after(value_json(change.before), value_json(change.after));
}

std::string change_json(const StructureChange& change) {
  return "{\"at\": " + number(change.index) + ", \"id\": " + number(change.id) +
         before_and_after(value_json(change.before), value_json(change.after));
}

std::string style_json(const StructureStyle& style) {
  return "{\"name\": " + quoted(style.name) + ", \"color\": " + quoted(style.color) +
         ", \"opacity\": " + format_real(style.opacity) + "}";
}

std::string change_json(const StyleChange& change) {
  return "{\"style\": " + number(change.structure) +
         before_and_after(style_json(change.before), style_json(change.after));
}

std::string division_json(const std::vector<Sweep>& sweeps, const std::vector<DividingPlane>& planes) {
  return nlohmann::json::parse(planes_json({sweeps, planes})).dump();
}

std::string change_json(const DivisionChange& change) {
  return "{\"division\": true" + before_and_after(division_json(change.sweeps_before, change.planes_before),
                                                  division_json(change.sweeps_after, change.planes_after));
}

std::string change_json(const TextChange& change) {
  return std::string("{\"text\": \"") + kTexts[static_cast<std::size_t>(change.text)] + "\"" +
         before_and_after(quoted(change.before), quoted(change.after));
}

std::size_t read_index(const JsonValue& value) { return static_cast<std::size_t>(value.integer(0, kMostIndices)); }

template <typename Item>
std::optional<Item> read_item(const JsonValue& value) {
  if (value.is_null()) return std::nullopt;
  Structure one;
  read_entry(value, one);
  auto& list = one.*Kind<Item>::list;
  if (list.empty()) value.fail(std::string("is not of the kind ") + Kind<Item>::key);
  return std::move(list.front());
}

template <typename Item>
Change read_item_change(const JsonValue& value) {
  return ItemChange<Item>{read_index(value.at("structure")), read_index(value.at(Kind<Item>::key)),
                          read_item<Item>(value.at("before")), read_item<Item>(value.at("after"))};
}

std::optional<Structure> read_optional_structure(const JsonValue& value) {
  return value.is_null() ? std::nullopt : std::optional(read_structure(value));
}

Change read_structure_change(const JsonValue& value) {
  return StructureChange{read_index(value.at("at")), read_index(value.at("id")),
                         read_optional_structure(value.at("before")), read_optional_structure(value.at("after"))};
}

StructureStyle read_style(const JsonValue& value) {
  // Versions without an opacity showed all surfaces alike.
  return {value.at("name").string(), read_color(value.at("color")),
          value.has("opacity") ? read_opacity(value.at("opacity")) : kUsualOpacity};
}

Change read_style_change(const JsonValue& value) {
  return StyleChange{read_index(value.at("style")), read_style(value.at("before")), read_style(value.at("after"))};
}

Change read_division_change(const JsonValue& value) {
  PlanesFile before = planes_of(value.at("before"));
  PlanesFile after = planes_of(value.at("after"));
  return DivisionChange{std::move(before.sweeps), std::move(after.sweeps), std::move(before.planes),
                        std::move(after.planes)};
}

Change read_text_change(const JsonValue& value) {
  const std::string name = value.at("text").string();
  const auto found = std::find(kTexts.begin(), kTexts.end(), name);
  if (found == kTexts.end()) value.at("text").fail("must be patient, operator, date or notes");
  return TextChange{static_cast<ExamText>(found - kTexts.begin()), value.at("before").string(),
                    value.at("after").string()};
}

// By the key that only this kind of change has.
constexpr std::array<std::pair<const char*, Change (*)(const JsonValue&)>, 7> kReaders{{
    {"contour", read_item_change<Contour>},
    {"extremity", read_item_change<Extremity>},
    {"absent", read_item_change<AbsentMark>},
    {"at", read_structure_change},
    {"style", read_style_change},
    {"division", read_division_change},
    {"text", read_text_change},
}};

Change read_change(const JsonValue& value) {
  for (const auto& [key, read] : kReaders) {
    if (value.has(key)) return read(value);
  }
  value.fail("is no change that this version knows");
}

}  // namespace

std::string edit_json(const Edit& edit) {
  std::string text = "{\"name\": " + quoted(edit.name) + ", \"changes\": [";
  for (std::size_t i = 0; i < edit.changes.size(); ++i) {
    if (i > 0) text += ", ";
    text += std::visit([](const auto& change) { return change_json(change); }, edit.changes[i]);
  }
  return text + "]}";
}

Edit read_edit(const JsonValue& value) {
  Edit edit;
  edit.name = value.at("name").string();
  const JsonValue changes = value.at("changes");
  for (std::size_t i = 0; i < changes.size(); ++i) edit.changes.push_back(read_change(changes[i]));
  return edit;
}

}  // namespace fathom
