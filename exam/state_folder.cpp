#include "exam/state_folder.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "core/error.h"
#include "core/json.h"
#include "core/text_file.h"

namespace fathom {

namespace {

constexpr std::size_t kMostRecent = 12;

std::filesystem::path recent_file() {
  const std::filesystem::path folder = state_folder();
  return folder.empty() ? folder : folder / "recent.json";
}

}  // namespace

std::filesystem::path state_folder() {
  // The XDG rules: relative paths are to be ignored.
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state && std::filesystem::path(state).is_absolute()) return std::filesystem::path(state) / "fathom";
  const char* home = std::getenv("HOME");
  if (!home || !std::filesystem::path(home).is_absolute()) return {};
  return std::filesystem::path(home) / ".local" / "state" / "fathom";
}

std::vector<std::filesystem::path> recent_files() {
  std::vector<std::filesystem::path> files;
  std::error_code code;
  const std::filesystem::path list = recent_file();
  if (list.empty() || !std::filesystem::exists(list, code)) return files;
  try {
    const nlohmann::json document = JsonValue::read_file(list);
    const JsonValue root(document, list);
    require_version(root, "fathom_recent", 1);
    const JsonValue names = root.at("files");
    for (std::size_t i = 0; i < names.size() && files.size() < kMostRecent; ++i) {
      const std::filesystem::path file = names[i].string();
      if (file.is_absolute() && std::filesystem::exists(file, code)) files.push_back(file);
    }
  } catch (const Error&) {
    files.clear();
  }
  return files;
}

void remember_recent(const std::filesystem::path& opened) {
  std::error_code code;
  const std::filesystem::path list = recent_file();
  std::filesystem::path file = std::filesystem::weakly_canonical(opened, code);
  if (code || list.empty()) return;
  if (file.filename() == "exam.json") file = file.parent_path();
  std::vector<std::filesystem::path> files = recent_files();
  std::erase(files, file);
  files.insert(files.begin(), file);
  if (files.size() > kMostRecent) files.resize(kMostRecent);
  nlohmann::json names = nlohmann::json::array();
  for (const auto& each : files) names.push_back(each.string());
  std::filesystem::create_directories(list.parent_path(), code);
  try {
    const nlohmann::json document = {{"fathom_recent", 1}, {"files", names}};
    write_text_file(list, document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } catch (const Error&) {
    // A list that cannot be kept must not keep anybody from work.
  }
}

}  // namespace fathom
