#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "exam/document.h"
#include "exam/history_file.h"

namespace fathom {

namespace {

constexpr const char* kJournal = "autosave.jsonl";
// How often a long action is put into the journal, seconds.
constexpr double kKeepOpen_s = 1.0;

// The first step that is not in what is on the disk; empty where the journal began with something else.
std::optional<std::size_t> first_unsaved(const Journal& journal, const std::string& content) {
  for (std::size_t i = journal.entries.size(); i-- > 0;) {
    const JournalEntry& entry = journal.entries[i];
    if (entry.step == JournalStep::kSaving && entry.text == content) return i + 1;
  }
  return journal.start.content == content ? std::optional<std::size_t>(0) : std::nullopt;
}

struct Replayed {
  ExamContent content;
  History history;
  std::filesystem::path calibration;
};

// Does one step again. False where it does not fit.
bool replay(const JournalEntry& entry, bool is_last, Replayed& to) {
  switch (entry.step) {
    case JournalStep::kSaving:
      return true;
    case JournalStep::kCalibration:
      to.calibration = entry.text;
      return true;
    case JournalStep::kOpen:
      if (!is_last || entry.edit->changes.empty()) return true;
      [[fallthrough]];
    case JournalStep::kDone:
      to.history.push(entry.edit);
      return apply(*entry.edit, Direction::kDo, to.content);
    case JournalStep::kUndone:
      if (to.history.to_undo()) to.history.step_back();
      return apply(*entry.edit, Direction::kUndo, to.content);
    case JournalStep::kRedone:
      if (to.history.to_redo()) {
        to.history.step_forward();
      } else {
        to.history.push(entry.edit);
      }
      return apply(*entry.edit, Direction::kDo, to.content);
  }
  return false;
}

}  // namespace

Document::~Document() {
  // An end by an exception is no clean one.
  if (autosave_ && std::uncaught_exceptions() == 0) drop_journal();
}

void Document::find_unsaved() {
  if (!options_.autosave) return;
  if (!has_folder()) {
    for (UnsavedWork& work : find_unsaved_work()) {
      if (work.recordings == base_.recordings && !unsaved_) unsaved_ = std::move(work);
    }
    return;
  }
  const std::filesystem::path file = exam_.folder / kJournal;
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return;
  if (is_in_use(file)) {
    messages_.push_back(exam_.folder.string() +
                        ": is open in another window; what is done here is not kept from a "
                        "crash, and the one that saves last wins; close one of them");
    autosave_failed_ = true;
    return;
  }
  try {
    const Journal journal = read_journal(file);
    if (!journal.entries.empty()) {
      unsaved_ = UnsavedWork{file, {}, journal.entries.size(), std::filesystem::last_write_time(file, code)};
    } else {
      std::filesystem::remove(file, code);
    }
  } catch (const Error& error) {
    // What cannot be read is kept, as nobody knows what it is worth.
    unsaved_ = UnsavedWork{file, {}, 0, std::filesystem::last_write_time(file, code)};
    messages_.push_back(error.what());
  }
}

void Document::recover() {
  if (!unsaved_) throw Error(title() + ": there is no unsaved work to recover");
  end_action();
  const std::filesystem::path file = unsaved_->journal;
  const Journal journal = read_journal(file);
  const auto fail = [&](const std::string& what) { throw Error(file.string() + ": " + what); };
  const auto first = first_unsaved(journal, digest_text(content_));
  if (!first) fail("is of other outlines, as the exam was changed since; delete it if it is not needed");
  Replayed replayed{content_, history_, {}};
  // Only where nothing of the journal is on the disk are its numbers of structures those to go by.
  if (*first == 0 && journal.start.ids.size() == content_.ids.size()) replayed.content.ids = journal.start.ids;
  const std::vector<int> counts = frame_counts(*scan_);
  for (std::size_t i = *first; i < journal.entries.size(); ++i) {
    const JournalEntry& entry = journal.entries[i];
    if (entry.edit) require_frames(*entry.edit, counts, file.string());
    if (!replay(entry, i + 1 == journal.entries.size(), replayed) || !could_be_saved(replayed.content)) {
      fail("step " + std::to_string(i + 1) + " does not fit the exam; delete it if it is not needed");
    }
  }
  auto autosave = std::make_shared<Autosave>(file, journal);
  content_ = std::move(replayed.content);
  history_ = std::move(replayed.history);
  for (const JournalEntry& entry : journal.entries) {
    if (!entry.edit) continue;
    for (const Change& change : entry.edit->changes) {
      if (const auto* c = std::get_if<StructureChange>(&change)) next_id_ = std::max(next_id_, c->id + 1);
    }
  }
  for (const std::uint64_t id : content_.ids) next_id_ = std::max(next_id_, id + 1);
  autosave_ = std::move(autosave);
  unsaved_.reset();
  // An action that was going on is one that ended now.
  if (!journal.entries.empty() && journal.entries.back().step == JournalStep::kOpen && history_.to_undo()) {
    this->journal(JournalStep::kDone, history_.to_undo());
  }
  touch_all();
  if (!replayed.calibration.empty()) set_calibration(replayed.calibration);
}

void Document::discard_unsaved() {
  if (!unsaved_) return;
  std::error_code code;
  std::filesystem::remove(unsaved_->journal, code);
  if (code) throw Error(unsaved_->journal.string() + ": cannot be deleted: " + code.message() + "; delete it by hand");
  unsaved_.reset();
}

void Document::open_journal() {
  try {
    const std::filesystem::path file = has_folder() ? exam_.folder / kJournal : untitled_journal();
    std::error_code code;
    if (has_folder() && unsaved_) {
      // Nobody said what to do with it.
      std::filesystem::path aside;
      for (int i = 1; aside.empty() || std::filesystem::exists(aside, code); ++i) {
        aside = exam_.folder / ("autosave-" + std::to_string(i) + ".jsonl");
      }
      std::filesystem::rename(file, aside, code);
      messages_.push_back(aside.string() + ": holds the work that was not recovered");
      unsaved_.reset();
    }
    autosave_ = std::make_shared<Autosave>(file, base_);
  } catch (const Error& error) {
    autosave_failed_ = true;
    messages_.push_back(error.what());
  }
}

void Document::drop_journal() {
  if (autosave_) autosave_->remove();
  autosave_.reset();
}

void Document::journal(JournalStep step, History::Item edit, std::string text) {
  if (!options_.autosave || autosave_failed_) return;
  if (!autosave_) open_journal();
  if (autosave_) autosave_->add({step, std::move(edit), std::move(text)});
}

void Document::journal_since(const History::Item& state) {
  const auto& edits = history_.edits();
  const auto at = std::find(edits.begin(), edits.end(), state);
  const std::size_t from = at == edits.end() ? 0 : static_cast<std::size_t>(at - edits.begin()) + 1;
  for (std::size_t i = from; i < history_.done(); ++i) journal(JournalStep::kDone, edits[i]);
  for (std::size_t i = from; i-- > history_.done();) journal(JournalStep::kUndone, edits[i]);
}

void Document::poll() {
  if (open_ && !open_->changes.empty()) {
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - open_kept_).count() >= kKeepOpen_s) {
      open_kept_ = now;
      journal(JournalStep::kOpen, std::make_shared<const Edit>(*open_));
    }
  }
  if (!autosave_) return;
  if (auto fault = autosave_->take_fault()) messages_.push_back(std::move(*fault));
}

}  // namespace fathom
