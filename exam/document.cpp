#include "exam/document.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/printable.h"
#include "exam/make_exam.h"
#include "exam/scan_division.h"
#include "registration/calibration.h"

namespace fathom {

std::string Document::title() const {
  const std::filesystem::path path = has_folder() ? std::filesystem::absolute(exam_.folder) : recordings_.front();
  const std::filesystem::path normal = path.lexically_normal();
  return printable((normal.has_filename() ? normal : normal.parent_path()).filename().string());
}

std::optional<std::size_t> Document::index_of(std::uint64_t id) const {
  const auto found = std::find(content_.ids.begin(), content_.ids.end(), id);
  if (found == content_.ids.end()) return std::nullopt;
  return static_cast<std::size_t>(found - content_.ids.begin());
}

const std::optional<Division>& Document::division() const {
  // Where nothing is stated, whether the scan is one sweep depends on where outlines are.
  const bool stated = !content_.sweeps.empty() || !content_.planes.empty() || scan_->recordings.size() > 1;
  const std::uint64_t now = stated ? std::max(division_revision_, placement_revision_) : revision_;
  if (division_of_ != now) {
    const bool was_divided = division_.has_value();
    division_ = division_of({content_.sweeps, content_.planes}, *scan_, content_.structures);
    // What one structure makes of the scan holds for all of them.
    if (division_of_ != 0 && division_.has_value() != was_divided) division_revision_ = revision_;
    division_of_ = now;
  }
  return division_;
}

bool Document::is_modified() const {
  return unsaved_setup_ || history_.state() != saved_ || (open_ && !open_->changes.empty());
}

void Document::begin_action(std::string name) {
  end_action();
  open_ = Edit{std::move(name), {}};
  open_kept_ = std::chrono::steady_clock::now();
}

bool Document::end_action() {
  if (!open_) return false;
  Edit edit = std::move(*open_);
  open_.reset();
  if (edit.changes.empty()) return false;
  finish(std::move(edit));
  return true;
}

void Document::cancel_action() {
  if (!open_) return;
  const bool undone = apply(*open_, Direction::kUndo, content_);
  assert(undone);
  static_cast<void>(undone);
  for (const Change& change : open_->changes) touch(change);
  open_.reset();
  // What the journal may hold of the action is void.
  if (autosave_) journal(JournalStep::kOpen, std::make_shared<const Edit>());
}

void Document::finish(Edit edit) {
  history_.push(std::make_shared<const Edit>(std::move(edit)));
  journal(JournalStep::kDone, history_.to_undo());
}

void Document::change(const char* name, Change change) {
  if (is_nothing(change)) return;
  const bool done = apply(change, Direction::kDo, content_);
  assert(done);
  static_cast<void>(done);
  touch(change);
  if (open_) {
    add_change(std::move(change), *open_);
  } else {
    Edit edit{name, {}};
    edit.changes.push_back(std::move(change));
    finish(std::move(edit));
  }
}

void Document::touch(const Change& change) {
  ++revision_;
  if (std::holds_alternative<DivisionChange>(change)) division_revision_ = revision_;
  if (std::holds_alternative<TextChange>(change) || std::holds_alternative<StyleChange>(change)) return;
  std::visit(
      [&](const auto& c) {
        if constexpr (requires { c.structure; }) {
          structure_revisions_[c.structure] = revision_;
        } else if constexpr (requires { c.id; }) {
          // Others move to other indices, so that all of them have changed for a view that goes by these.
          structure_revisions_.assign(content_.structures.size(), revision_);
        }
      },
      change);
}

void Document::touch_all() {
  structure_revisions_.assign(content_.structures.size(), ++revision_);
  division_revision_ = placement_revision_ = revision_;
}

std::optional<std::string> Document::undo_name() const {
  if (open_ && !open_->changes.empty()) return open_->name;
  const auto edit = history_.to_undo();
  return edit ? std::optional(edit->name) : std::nullopt;
}

std::optional<std::string> Document::redo_name() const {
  const auto edit = history_.to_redo();
  return edit ? std::optional(edit->name) : std::nullopt;
}

bool Document::undo() {
  end_action();
  const auto edit = history_.to_undo();
  if (!edit) return false;
  if (!apply(*edit, Direction::kUndo, content_)) throw Error(title() + ": the history does not fit; this is a fault");
  history_.step_back();
  journal(JournalStep::kUndone, edit);
  for (const Change& change : edit->changes) touch(change);
  return true;
}

bool Document::redo() {
  end_action();
  const auto edit = history_.to_redo();
  if (!edit) return false;
  if (!apply(*edit, Direction::kDo, content_)) throw Error(title() + ": the history does not fit; this is a fault");
  history_.step_forward();
  journal(JournalStep::kRedone, edit);
  for (const Change& change : edit->changes) touch(change);
  return true;
}

void Document::set_calibration(const std::filesystem::path& file) {
  const Calibration calibration = read_calibration(file, options_.names.probe);
  Exam placed = exam_;
  placed.sweeps = content_.sweeps;
  scan_ = std::make_shared<const Scan>(has_folder() ? open_scan(placed, calibration, options_.names)
                                                    : open_scan(recordings_.front(), calibration, options_.names));
  calibration_ = file;
  calibrated_ = true;
  unsaved_setup_ = true;
  ++setup_;
  exam_.results = nullptr;
  touch_all();
  std::error_code code;
  journal(JournalStep::kCalibration, nullptr, std::filesystem::absolute(file, code).string());
}

void Document::set_results(const nlohmann::json& results) {
  exam_.results = results;
  measured_ = measured_digest(content_);
  unsaved_setup_ = true;
  ++setup_;
}

}  // namespace fathom
