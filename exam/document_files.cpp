#include <algorithm>
#include <array>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text_file.h"
#include "exam/document.h"
#include "exam/history_file.h"
#include "exam/make_exam.h"
#include "registration/calibration.h"

namespace fathom {

namespace {

constexpr std::uintmax_t kLongestCalibration = std::uintmax_t{8} << 20;  // as its reader allows

constexpr std::array<std::string Exam::*, kExamTexts> kTexts{&Exam::patient, &Exam::operator_name, &Exam::date,
                                                             &Exam::notes};

std::vector<Structure> read_outlines(const std::filesystem::path& file, const Scan& scan) {
  if (file.empty()) return {};
  std::vector<Structure> structures = read_contours(file);
  require_measurable(structures, frame_counts(scan), OpenContours::kAllow, file.string());
  return structures;
}

std::string free_name(const std::filesystem::path& folder, const std::string& stem, const std::string& extension) {
  std::error_code code;
  for (int number = 1;; ++number) {
    const std::string name = stem + (number > 1 ? "-" + std::to_string(number) : std::string()) + extension;
    if (!std::filesystem::exists(folder / name, code)) return name;
  }
}

}  // namespace

Document::Document(const std::filesystem::path& path, const DocumentOptions& options)
    : options_(options), history_(options.history_bytes) {
  is_exam(path) ? open_exam(path) : open_recording_alone(path);
  touch_all();
}

void Document::open_exam(const std::filesystem::path& path) {
  exam_ = read_exam(path);
  for (const std::string& name : exam_.recordings) recordings_.push_back(file_of(exam_, name));
  if (!exam_.calibration.empty()) calibration_ = file_of(exam_, exam_.calibration);
  calibrated_ = !calibration_.empty();
  const Calibration calibration = calibrated_ ? read_calibration(calibration_, options_.names.probe) : Calibration();
  scan_ = std::make_shared<const Scan>(open_scan(exam_, calibration, options_.names));
  set_content(
      read_outlines(exam_.structures.empty() ? std::filesystem::path() : file_of(exam_, exam_.structures), *scan_));
  for (std::size_t i = 0; i < kExamTexts; ++i) content_.texts[i] = exam_.*kTexts[i];
  content_.sweeps = exam_.sweeps;
  content_.planes = exam_.dividing_planes;
  measured_ = measured_digest(content_);
  load_history();
  set_base();
  find_unsaved();
}

void Document::open_recording_alone(const std::filesystem::path& path) {
  recordings_ = {path};
  calibration_ = options_.calibration;
  calibrated_ = !calibration_.empty();
  const Calibration calibration = calibrated_ ? read_calibration(calibration_, options_.names.probe) : Calibration();
  scan_ = std::make_shared<const Scan>(open_scan(path, calibration, options_.names));
  set_content(read_outlines(options_.contours, *scan_));
  set_base();
  base_.recordings = {std::filesystem::absolute(path)};
  if (calibrated_) base_.calibration = std::filesystem::absolute(calibration_);
  if (!options_.contours.empty()) base_.contours = std::filesystem::absolute(options_.contours);
  find_unsaved();
}

void Document::set_content(std::vector<Structure> structures) {
  for (Structure& structure : structures) {
    put_in_order(structure);
    content_.ids.push_back(next_id_++);
  }
  content_.structures = std::move(structures);
}

void Document::set_base() {
  outlines_on_disk_ = outlines_digest(content_);
  saved_ = history_.state();
  unsaved_setup_ = false;
  base_ = {digest_text(content_), content_.ids, {}, {}, {}};
}

void Document::load_history() {
  const std::filesystem::path file = exam_.folder / kHistoryFile;
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return;
  try {
    SavedHistory saved = read_history(file, content_, frame_counts(*scan_));
    content_.ids = std::move(saved.ids);
    // Also those of structures that are not there now have theirs.
    for (const auto& edit : saved.edits) {
      for (const Change& change : edit->changes) {
        if (const auto* c = std::get_if<StructureChange>(&change)) next_id_ = std::max(next_id_, c->id + 1);
      }
    }
    for (const std::uint64_t id : content_.ids) next_id_ = std::max(next_id_, id + 1);
    history_ = History(options_.history_bytes, std::move(saved.edits), saved.done);
  } catch (const Error& error) {
    messages_.push_back(std::string(error.what()) + " (what was done before cannot be undone)");
  }
}

Exam Document::exam_to_save() const {
  Exam exam = exam_;
  for (std::size_t i = 0; i < kExamTexts; ++i) exam.*kTexts[i] = content_.texts[i];
  exam.sweeps = content_.sweeps;
  exam.dividing_planes = content_.planes;
  if (measured_digest(content_) != measured_) exam.results = nullptr;
  return exam;
}

DocumentSnapshot Document::snapshot() const {
  return {title(), exam_to_save(), scan_, recordings_, calibration_, content_.structures, division()};
}

std::shared_ptr<PendingSave> Document::begin_save() {
  end_action();
  if (!has_folder()) throw Error(title() + ": is no exam yet; save it as one, in a folder of its own");
  auto pending = std::make_shared<PendingSave>(
      PendingSave{exam_to_save(), content_, history_, setup_, false, {}, {}, false, autosave_});
  Exam& exam = pending->exam;
  // A file without changes is left alone, with all that others wrote into it.
  pending->outlines_changed = outlines_digest(content_) != outlines_on_disk_;
  const bool inside = !exam.calibration.empty() && calibration_ == exam.folder / exam.calibration;
  if (!inside) pending->calibration = calibration_;
  if (autosave_) journal(JournalStep::kSaving, nullptr, digest_text(content_));
  return pending;
}

std::shared_ptr<PendingSave> Document::begin_save_as(const std::filesystem::path& folder) {
  end_action();
  auto pending = std::make_shared<PendingSave>(
      PendingSave{exam_to_save(), content_, history_, setup_, true, recordings_, calibration_, true, autosave_});
  pending->exam.folder = folder;
  return pending;
}

void PendingSave::write(const Progress& progress) {
  if (autosave) autosave->flush();
  const std::string undo = history_json(history, content);
  if (is_new) {
    ExamParts parts;
    parts.recordings = recordings;
    parts.calibration = calibration;
    parts.contours_text = contours_json(content.structures);
    parts.history_text = undo;
    exam = create_exam(std::move(exam), parts, progress);
    exam.document = nlohmann::json::parse(exam_text(exam));
    return;
  }
  std::vector<std::unique_ptr<AtomicFile>> files;
  const auto add = [&](const std::string& name, const std::string& text) {
    files.push_back(std::make_unique<AtomicFile>(exam.folder / name));
    files.back()->write(text);
  };
  if (!calibration.empty()) {
    exam.calibration = free_name(exam.folder, calibration.stem().string(), calibration.extension().string());
    add(exam.calibration, read_text_file(calibration, kLongestCalibration));
  }
  if (outlines_changed) {
    if (exam.structures.empty()) exam.structures = free_name(exam.folder, "contours", ".json");
    add(exam.structures, contours_json(content.structures));
  }
  std::error_code code;
  if (!history.edits().empty() || std::filesystem::exists(exam.folder / kHistoryFile, code)) add(kHistoryFile, undo);
  const std::string text = exam_text(exam);
  add(exam_json(exam).filename().string(), text);  // the last, as it names the others
  std::vector<AtomicFile*> all;
  for (const auto& file : files) all.push_back(file.get());
  AtomicFile::commit_all(all);
  exam.document = nlohmann::json::parse(text);
}

void Document::finish_save(const PendingSave& saved) {
  const bool same_setup = setup_ == saved.setup;
  const nlohmann::json results = std::move(exam_.results);
  exam_ = saved.exam;
  recordings_.clear();
  for (const std::string& name : exam_.recordings) recordings_.push_back(exam_.folder / name);
  if (same_setup && !exam_.calibration.empty()) calibration_ = exam_.folder / exam_.calibration;
  if (!same_setup) exam_.results = results;
  unsaved_setup_ = !same_setup;
  saved_ = saved.history.state();
  outlines_on_disk_ = outlines_digest(saved.content);
  base_ = {digest_text(saved.content), saved.content.ids, {}, {}, {}};
  const bool edited_meanwhile = history_.state() != saved_;
  if (edited_meanwhile && !saved.is_new) return;  // the journal tells which of its steps are saved
  drop_journal();
  if (edited_meanwhile) journal_since(saved_);
}

void Document::save() {
  const auto pending = begin_save();
  pending->write();
  finish_save(*pending);
}

void Document::save_as(const std::filesystem::path& folder, const Progress& progress) {
  const auto pending = begin_save_as(folder);
  pending->write(progress);
  finish_save(*pending);
}

}  // namespace fathom
