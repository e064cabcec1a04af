#include "viewer/settings.h"

#include <algorithm>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json.h"
#include "core/text_file.h"

namespace fathom {

namespace {

// One visitor reads and writes, so that no field is forgotten in either.
template <typename Visit>
void visit_fields(Settings& settings, const Visit& visit) {
  visit("width", settings.width);
  visit("height", settings.height);
  visit("dark", settings.dark);
  visit("scale", settings.scale);
  visit("left", settings.left);
  visit("middle", settings.middle);
  visit("upper", settings.upper);
  visit("main", settings.main);
  visit("show_outline", settings.show_outline);
  visit("show_reslice", settings.show_reslice);
  visit("show_measurements", settings.show_measurements);
  visit("show_timeline", settings.show_timeline);
  visit("image_source", settings.image_source);
  visit("tracker_source", settings.tracker_source);
}

void keep_in_range(Settings& settings) {
  settings.width = std::clamp(settings.width, 320, 16384);
  settings.height = std::clamp(settings.height, 240, 16384);
  if (!(settings.scale >= 0.5F && settings.scale <= 4.0F)) settings.scale = 0.0F;
  for (float* share : {&settings.left, &settings.middle, &settings.upper, &settings.main}) {
    *share = std::clamp(*share, 0.08F, 0.92F);
  }
}

}  // namespace

std::filesystem::path settings_file() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  std::filesystem::path folder;
  if (config != nullptr && *config == '/') {
    folder = config;
  } else if (home != nullptr && *home != '\0') {
    folder = std::filesystem::path(home) / ".config";
  } else {
    return {};
  }
  return folder / "fathom" / "viewer.json";
}

Settings read_settings(const std::filesystem::path& file) {
  Settings settings;
  std::error_code error;
  if (file.empty() || !std::filesystem::is_regular_file(file, error)) return settings;
  try {
    const nlohmann::json document = JsonValue::read_file(file);
    visit_fields(settings, [&](const char* name, auto& value) {
      const auto found = document.find(name);
      if (found == document.end()) return;
      try {
        found->get_to(value);
      } catch (const nlohmann::json::exception&) {
        // Another type: the default stays.
      }
    });
  } catch (const Error&) {
    return {};
  }
  keep_in_range(settings);
  return settings;
}

void write_settings(const Settings& settings, const std::filesystem::path& file) {
  if (file.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  nlohmann::ordered_json document;
  Settings copy = settings;
  visit_fields(copy, [&](const char* name, const auto& value) { document[name] = value; });
  write_text_file(file, document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace fathom
