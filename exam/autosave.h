#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "exam/edit.h"
#include "exam/history.h"

namespace fathom {

/// What a journal of unsaved work begins with: what the work was done on.
struct JournalStart {
  std::string content;                            ///< digest_text of it
  std::vector<std::uint64_t> ids;                 ///< of its structures
  std::vector<std::filesystem::path> recordings;  ///< absolute; of a document that is no exam yet, else empty
  std::filesystem::path calibration;              ///< of such a document; may be empty
  std::filesystem::path contours;                 ///< that it began with; may be empty
};

enum class JournalStep {
  kDone,    ///< an edit was done
  kUndone,  ///< or undone
  kRedone,  ///< or done again
  kOpen,    ///< part of an action that is still going on; the next step takes its place
  kSaving,  ///< the content with this digest is about to be saved
  kCalibration
};

struct JournalEntry {
  JournalStep step = JournalStep::kDone;
  History::Item edit;  ///< of the first four
  std::string text;    ///< of the others: digest or path
};

struct Journal {
  JournalStart start;
  std::vector<JournalEntry> entries;
  std::uintmax_t bytes = 0;  ///< of what is whole; a line that a crash cut off comes behind
};

/// Reads a journal, up to a last line that is not whole. Throws Error where it is damaged elsewhere, of a newer version
/// or longer than 256 MiB.
Journal read_journal(const std::filesystem::path& path);

/// Whether a running program is writing to this journal.
bool is_in_use(const std::filesystem::path& journal);

/// Writes unsaved work to a file as it is done, from a thread of its own: the caller never waits for the disk. What was
/// handed over is safe as soon as the disk has taken it, whatever happens to the program.
class Autosave {
 public:
  /// A new journal at `path`, which must not exist. Throws Error where it cannot be made.
  Autosave(const std::filesystem::path& path, const JournalStart& start);
  /// Goes on with a journal that was read, and cuts off what is not whole. Throws Error also where it is in use.
  Autosave(const std::filesystem::path& path, const Journal& journal);
  /// Writes what is left; the file stays.
  ~Autosave();
  Autosave(const Autosave&) = delete;
  Autosave& operator=(const Autosave&) = delete;

  void add(JournalEntry entry);
  /// Waits until all is on the disk.
  void flush();
  /// Deletes the file: the work is saved, or not wanted.
  void remove();
  /// Why work could not be written, once; empty where all is well.
  std::optional<std::string> take_fault();
  const std::filesystem::path& path() const { return path_; }

 private:
  void open(int flags);
  void run();
  void write(const std::string& text);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uintmax_t bytes_ = 0;  ///< of whole lines; of the writing thread
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable written_;
  std::vector<JournalEntry> waiting_;
  bool writing_ = false;
  bool stopping_ = false;
  std::optional<std::string> fault_;
  std::thread thread_;
};

/// Work that was lost in a crash, of documents that were no exams yet.
struct UnsavedWork {
  std::filesystem::path journal;
  std::vector<std::filesystem::path> recordings;
  std::size_t actions = 0;
  std::filesystem::file_time_type time;  ///< of the last action
};

/// All that is found in state_folder(), the latest first, but what running programs are writing to. Never throws:
/// damaged journals are passed over.
std::vector<UnsavedWork> find_unsaved_work();

/// A free name for the journal of a document that is no exam. Makes the folder. Throws Error.
std::filesystem::path untitled_journal();

}  // namespace fathom
