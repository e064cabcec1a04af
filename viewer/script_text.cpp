#include <array>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "viewer/script.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fathom {

namespace {

using Step = ScriptStep;
constexpr std::array<const char*, 3> kButtons{"left", "right", "middle"};
constexpr int kFarthest = 100000;  // frames, pixels

struct Builder {
  ScriptText text;
  std::size_t event = 0;

  void add(Step step) {
    text.steps.push_back(std::move(step));
    text.event_of.push_back(event);
  }
  void input(InputEvent input) { add({.kind = Step::Kind::kInput, .input = std::move(input)}); }
  void move(const ScriptPoint& point) { add({.kind = Step::Kind::kMove, .point = point}); }
  void frames(int count) { add({.kind = Step::Kind::kFrames, .count = count}); }
  void button(int code, bool down) { input({.kind = InputEvent::Kind::kButton, .code = code, .down = down}); }
  void key(int code, bool down) { input({.kind = InputEvent::Kind::kKey, .code = code, .down = down}); }
  void modifiers(const KeyChord& chord, bool down) {
    if (chord.ctrl) key(GLFW_KEY_LEFT_CONTROL, down);
    if (chord.shift) key(GLFW_KEY_LEFT_SHIFT, down);
    if (chord.alt) key(GLFW_KEY_LEFT_ALT, down);
  }
};

Eigen::Vector3d vector_of(const JsonValue& value, std::size_t count) {
  if (value.size() != count) value.fail("must be " + std::to_string(count) + " numbers");
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) vector[static_cast<Eigen::Index>(i)] = value[i].number();
  return vector;
}

// [x, y] in the window, {"image": [x, y]}, {"space": [x, y, z]}, {"item": NAME, "at": [0..1, 0..1]}, or just "NAME".
ScriptPoint point_of(const JsonValue& value, bool is_text, bool is_array) {
  if (is_text) return {ScriptPoint::Kind::kItem, value.string(), {0.5, 0.5, 0.0}};
  if (is_array) return {ScriptPoint::Kind::kWindow, "", vector_of(value, 2)};
  if (value.has("image")) return {ScriptPoint::Kind::kImage, "the image in Review", vector_of(value.at("image"), 2)};
  if (value.has("space")) return {ScriptPoint::Kind::kSpace, "the Outline pane", vector_of(value.at("space"), 3)};
  const Eigen::Vector3d at = value.has("at") ? vector_of(value.at("at"), 2) : Eigen::Vector3d(0.5, 0.5, 0.0);
  return {ScriptPoint::Kind::kItem, value.at("item").string(), at};
}

int button_of(const JsonValue& event) {
  if (!event.has("button")) return 0;
  const std::string name = event.at("button").string();
  for (std::size_t i = 0; i < kButtons.size(); ++i) {
    if (name == kButtons[i]) return static_cast<int>(i);
  }
  event.at("button").fail("must be left, right or middle");
}

KeyChord held(const JsonValue& event) {
  if (!event.has("held")) return {};
  return parse_chord(event.at("held").string() + "+A");
}

void add_text(Builder& builder, const std::string& text) {
  for (const char c : text) builder.input({.kind = InputEvent::Kind::kText, .text = static_cast<unsigned char>(c)});
  builder.frames(2);
}

void add_key(Builder& builder, const std::string& text) {
  const KeyChord chord = parse_chord(text);
  builder.modifiers(chord, true);
  builder.key(chord.key, true);
  builder.frames(1);
  builder.key(chord.key, false);
  builder.modifiers(chord, false);
  builder.frames(1);
}

void add_click(Builder& builder, const ScriptPoint& point, int button, int times) {
  builder.move(point);
  builder.frames(1);
  for (int i = 0; i < times; ++i) {
    builder.button(button, true);
    builder.button(button, false);
  }
  builder.frames(2);
}

// "File/Save as..." by clicks on the menu's name and the entry.
void add_menu(Builder& builder, const std::string& path) {
  std::size_t end = path.find('/');
  for (; end != std::string::npos; end = path.find('/', end + 1)) {
    add_click(builder, {ScriptPoint::Kind::kItem, "menu:" + path.substr(0, end), {0.5, 0.5, 0.0}}, 0, 1);
  }
  add_click(builder, {ScriptPoint::Kind::kItem, "menu:" + path, {0.5, 0.5, 0.0}}, 0, 1);
}

void add_drag(Builder& builder, const nlohmann::json& json, const JsonValue& event) {
  const JsonValue points = event.at("drag");
  if (points.size() < 2) points.fail("must be at least two places");
  const KeyChord chord = held(event);
  const int button = button_of(event);
  builder.modifiers(chord, true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& raw = json.at("drag")[i];
    builder.move(point_of(points[i], raw.is_string(), raw.is_array()));
    if (i == 0) {
      builder.frames(1);
      builder.button(button, true);
    }
  }
  builder.frames(1);
  builder.button(button, false);
  builder.modifiers(chord, false);
  builder.frames(2);
}

void add_wheel(Builder& builder, const nlohmann::json& json, const JsonValue& event) {
  if (event.has("at")) builder.move(point_of(event.at("at"), json["at"].is_string(), json["at"].is_array()));
  builder.frames(1);
  const KeyChord chord = held(event);
  builder.modifiers(chord, true);
  const double steps = event.at("wheel").number();
  builder.input({.kind = InputEvent::Kind::kWheel, .y = steps});
  builder.frames(1);
  builder.modifiers(chord, false);
  builder.frames(1);
}

using Adder = void (*)(Builder&, const nlohmann::json&, const JsonValue&);
constexpr std::array<std::pair<const char*, Adder>, 15> kEvents{{
    {"move",
     [](Builder& b, const nlohmann::json& json, const JsonValue& event) {
       b.move(point_of(event.at("move"), json["move"].is_string(), json["move"].is_array()));
       b.frames(1);
     }},
    {"press",
     [](Builder& b, const nlohmann::json&, const JsonValue& e) { b.button(e.at("press").integer(0, 2), true); }},
    {"release",
     [](Builder& b, const nlohmann::json&, const JsonValue& e) { b.button(e.at("release").integer(0, 2), false); }},
    {"click",
     [](Builder& b, const nlohmann::json& json, const JsonValue& event) {
       const KeyChord chord = held(event);
       b.modifiers(chord, true);
       const int times = event.has("times") ? event.at("times").integer(1, 3) : 1;
       add_click(b, point_of(event.at("click"), json["click"].is_string(), json["click"].is_array()), button_of(event),
                 times);
       b.modifiers(chord, false);
     }},
    {"drag", add_drag},
    {"wheel", add_wheel},
    {"key", [](Builder& b, const nlohmann::json&, const JsonValue& e) { add_key(b, e.at("key").string()); }},
    {"text", [](Builder& b, const nlohmann::json&, const JsonValue& e) { add_text(b, e.at("text").string()); }},
    {"menu", [](Builder& b, const nlohmann::json&, const JsonValue& e) { add_menu(b, e.at("menu").string()); }},
    {"drop",
     [](Builder& b, const nlohmann::json&, const JsonValue& e) {
       b.input({.kind = InputEvent::Kind::kDrop, .paths = {e.at("drop").string()}});
       b.frames(2);
     }},
    {"frames",
     [](Builder& b, const nlohmann::json&, const JsonValue& e) { b.frames(e.at("frames").integer(1, kFarthest)); }},
    {"idle", [](Builder& b, const nlohmann::json&, const JsonValue&) { b.add({.kind = Step::Kind::kIdle}); }},
    {"wait_s", [](Builder& b, const nlohmann::json&,
                  const JsonValue& e) { b.add({.kind = Step::Kind::kWait, .seconds = e.at("wait_s").number()}); }},
    {"picture",
     [](Builder& b, const nlohmann::json&, const JsonValue& e) {
       b.add({.kind = Step::Kind::kPicture,
              .file = e.at("picture").string(),
              .item = e.has("of") ? e.at("of").string() : std::string()});
     }},
    {"dump", [](Builder& b, const nlohmann::json&,
                const JsonValue& e) { b.add({.kind = Step::Kind::kDump, .file = e.at("dump").string()}); }},
}};

void add_event(Builder& builder, const nlohmann::json& json, const JsonValue& event) {
  if (event.has("quit")) return builder.add({.kind = Step::Kind::kQuit});
  if (event.has("bench")) {
    const int frames = event.has("count") ? event.at("count").integer(1, kFarthest) : 100;
    return builder.add({.kind = Step::Kind::kBench, .count = frames, .file = event.at("bench").string()});
  }
  if (event.has("keys")) return builder.add({.kind = Step::Kind::kKeys, .file = event.at("keys").string()});
  for (const auto& [name, adder] : kEvents) {
    if (event.has(name)) return adder(builder, json, event);
  }
  event.fail("is no event that the viewer knows; see docs/viewer.md");
}

}  // namespace

ScriptText read_script(const std::filesystem::path& file) {
  const nlohmann::json document = JsonValue::read_file(file);
  const JsonValue root(document, file);
  Builder builder;
  if (root.has("window")) {
    builder.text.width = root.at("window")[0].integer(200, kFarthest);
    builder.text.height = root.at("window")[1].integer(150, kFarthest);
  }
  const JsonValue events = root.at("events");
  for (std::size_t i = 0; i < events.size(); ++i) {
    builder.event = i;
    add_event(builder, document.at("events")[i], events[i]);
  }
  return std::move(builder.text);
}

}  // namespace fathom
