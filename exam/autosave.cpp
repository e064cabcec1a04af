#include "exam/autosave.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/text_file.h"
#include "exam/edit_json.h"
#include "exam/state_folder.h"

namespace fathom {

namespace {

constexpr const char* kMarker = "fathom_autosave";
constexpr std::uintmax_t kLongest = std::uintmax_t{256} << 20;
constexpr std::uintmax_t kMuch = kLongest / 2;
constexpr int kDeepest = 32;  // levels of nesting, as JsonValue::read_file

struct StepKey {
  JournalStep step;
  const char* key;
  bool has_edit;
};
constexpr std::array<StepKey, 6> kSteps{{{JournalStep::kDone, "do", true},
                                         {JournalStep::kUndone, "undo", true},
                                         {JournalStep::kRedone, "redo", true},
                                         {JournalStep::kOpen, "open", true},
                                         {JournalStep::kSaving, "saving", false},
                                         {JournalStep::kCalibration, "calibration", false}}};

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string line_of(const JournalEntry& entry) {
  const auto found =
      std::find_if(kSteps.begin(), kSteps.end(), [&](const StepKey& step) { return step.step == entry.step; });
  return std::string("{\"") + found->key + "\": " + (found->has_edit ? edit_json(*entry.edit) : quoted(entry.text)) +
         "}\n";
}

std::string line_of(const JournalStart& start) {
  nlohmann::json line = {{kMarker, 1}, {"content", start.content}, {"ids", start.ids}};
  for (const auto& recording : start.recordings) line["recordings"].push_back(recording.string());
  if (!start.calibration.empty()) line["calibration"] = start.calibration.string();
  if (!start.contours.empty()) line["contours"] = start.contours.string();
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

JournalStart read_start(const JsonValue& root) {
  require_version(root, kMarker, 1);
  JournalStart start;
  start.content = root.at("content").string();
  const JsonValue ids = root.at("ids");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    start.ids.push_back(static_cast<std::uint64_t>(ids[i].integer(1, 1 << 30)));
  }
  if (root.has("recordings")) {
    const JsonValue names = root.at("recordings");
    for (std::size_t i = 0; i < names.size(); ++i) start.recordings.emplace_back(names[i].string());
  }
  if (root.has("calibration")) start.calibration = root.at("calibration").string();
  if (root.has("contours")) start.contours = root.at("contours").string();
  return start;
}

JournalEntry read_entry_line(const JsonValue& root) {
  for (const StepKey& step : kSteps) {
    if (!root.has(step.key)) continue;
    if (step.has_edit) return {step.step, std::make_shared<const Edit>(read_edit(root.at(step.key))), {}};
    return {step.step, nullptr, root.at(step.key).string()};
  }
  root.fail("is no step that this version knows; open the work with a newer one");
}

// Brackets are counted before the parser is let at them, which goes as deep as a line asks.
bool is_too_deep(std::string_view line) {
  int depth = 0;
  int deepest = 0;
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (inside && line[i] == '\\') {
      ++i;
    } else if (line[i] == '"') {
      inside = !inside;
    } else if (!inside && (line[i] == '[' || line[i] == '{')) {
      deepest = std::max(deepest, ++depth);
    } else if (!inside && (line[i] == ']' || line[i] == '}')) {
      --depth;
    }
  }
  return deepest > kDeepest;
}

}  // namespace

Journal read_journal(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, kLongest);
  Journal journal;
  std::size_t at = 0;
  for (int line = 1; at < text.size(); ++line) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;  // the crash came in the middle of it
    const std::string_view content(text.data() + at, end - at);
    const std::string where = path.string() + ", line " + std::to_string(line);
    nlohmann::json document;
    if (!is_too_deep(content)) document = nlohmann::json::parse(content, nullptr, false);
    if (!document.is_object()) throw Error(where + ": is no JSON object; the work behind it cannot be recovered");
    const JsonValue root(document, where);
    if (line == 1) {
      journal.start = read_start(root);
    } else {
      journal.entries.push_back(read_entry_line(root));
    }
    at = end + 1;
    journal.bytes = at;
  }
  if (journal.bytes == 0) throw Error(path.string() + ": holds no work; delete it");
  return journal;
}

bool is_in_use(const std::filesystem::path& journal) {
  const int descriptor = ::open(journal.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

void Autosave::open(int flags) {
  descriptor_ = ::open(path_.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor_ < 0) {
    throw Error(path_.string() + ": cannot be written (" + std::strerror(errno) +
                "), so that work is not safe from a crash; save often, or check the folder");
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor_);
    throw Error(path_.string() + ": is open in another window; close it there");
  }
}

Autosave::Autosave(const std::filesystem::path& path, const JournalStart& start) : path_(path) {
  open(O_WRONLY | O_CREAT | O_EXCL | O_APPEND);
  write(line_of(start));
  thread_ = std::thread([this] { run(); });
}

Autosave::Autosave(const std::filesystem::path& path, const Journal& journal) : path_(path) {
  open(O_WRONLY | O_APPEND);
  if (::ftruncate(descriptor_, static_cast<off_t>(journal.bytes)) != 0) {
    ::close(descriptor_);
    throw Error(path_.string() + ": cannot be written (" + std::strerror(errno) + "); check the disk");
  }
  bytes_ = journal.bytes;
  thread_ = std::thread([this] { run(); });
}

Autosave::~Autosave() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  ::close(descriptor_);
}

void Autosave::add(JournalEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    // A part of an action that nobody has written yet is stale.
    if (!waiting_.empty() && waiting_.back().step == JournalStep::kOpen) waiting_.pop_back();
    waiting_.push_back(std::move(entry));
  }
  wake_.notify_all();
}

void Autosave::flush() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [&] { return waiting_.empty() && !writing_; });
}

void Autosave::remove() {
  flush();
  ::unlink(path_.c_str());
}

std::optional<std::string> Autosave::take_fault() {
  const std::lock_guard lock(mutex_);
  return std::exchange(fault_, std::nullopt);
}

void Autosave::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::vector<JournalEntry> entries = std::exchange(waiting_, {});
    writing_ = true;
    lock.unlock();
    std::string text;
    for (const JournalEntry& entry : entries) text += line_of(entry);
    write(text);
    lock.lock();
    writing_ = false;
    written_.notify_all();
  }
}

void Autosave::write(const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t now = ::write(descriptor_, text.data() + done, text.size() - done);
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) break;
    done += static_cast<std::size_t>(now);
  }
  std::string why;
  if (done < text.size() || ::fdatasync(descriptor_) != 0) {
    why = std::strerror(errno);
    // Half a line would spoil those behind it.
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes_)) != 0) why += ", and what was written is cut off";
  } else {
    bytes_ += text.size();
    if (bytes_ < kMuch) return;
    why = "it is too much";
  }
  const std::lock_guard lock(mutex_);
  fault_ = path_.string() + ": work cannot be kept safe from a crash (" + why + "); save it, or free space on the disk";
}

std::vector<UnsavedWork> find_unsaved_work() {
  std::vector<UnsavedWork> found;
  std::error_code code;
  const std::filesystem::path folder = state_folder();
  if (folder.empty()) return found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    const std::filesystem::path& path = entry.path();
    if (path.filename().string().rfind("untitled-", 0) != 0 || is_in_use(path)) continue;
    try {
      const Journal journal = read_journal(path);
      if (journal.start.recordings.empty() || journal.entries.empty()) continue;
      found.push_back({path, journal.start.recordings, journal.entries.size(), entry.last_write_time(code)});
    } catch (const Error&) {
      continue;
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.time > b.time; });
  return found;
}

std::filesystem::path untitled_journal() {
  const std::filesystem::path folder = state_folder();
  if (folder.empty()) throw Error("there is no home folder to keep unsaved work in; set HOME or XDG_STATE_HOME");
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) throw Error(folder.string() + ": cannot be made: " + code.message() + "; unsaved work is not kept");
  for (int number = 1;; ++number) {
    const std::filesystem::path path =
        folder / ("untitled-" + std::to_string(::getpid()) + "-" + std::to_string(number) + ".jsonl");
    if (!std::filesystem::exists(path, code)) return path;
  }
}

}  // namespace fathom
