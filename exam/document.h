#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exam/autosave.h"
#include "exam/edit.h"
#include "exam/exam.h"
#include "exam/history.h"
#include "exam/scan.h"
#include "registration/division.h"
#include "registration/frame_locator.h"

namespace fathom {

struct DocumentOptions {
  FrameNames names;
  std::filesystem::path calibration;  ///< of a recording without exam; empty: none
  std::filesystem::path contours;     ///< to begin with, of a recording without exam; empty: none
  std::size_t history_bytes = std::size_t{256} << 20;
  bool autosave = true;  ///< false: a crash loses what was not saved
};

/// A document as it was at one moment, for work beside the main thread.
struct DocumentSnapshot {
  std::string title;
  Exam exam;  ///< as it would be saved, but with the names of files that it was opened with
  std::shared_ptr<const Scan> scan;
  std::vector<std::filesystem::path> recordings;  ///< the files
  std::filesystem::path calibration;              ///< the file; empty where there is none, and nothing may be measured
  std::vector<Structure> structures;
  std::optional<Division> division;
};

/// A document on its way to the disk: made by Document::begin_save, written by any thread, reported to finish_save.
struct PendingSave {
  Exam exam;  ///< with the folder to save to
  ExamContent content;
  History history;
  std::uint64_t setup = 0;
  bool is_new = false;                            ///< the folder is to become an exam
  std::vector<std::filesystem::path> recordings;  ///< of a new one
  std::filesystem::path calibration;              ///< to be copied into the folder; empty: stays as it is
  bool outlines_changed = false;
  std::shared_ptr<Autosave> autosave;

  /// Throws Error, with the old files as they were; Cancelled.
  void write(const Progress& progress = {});
};

/// One exam, or one recording that is no exam yet, being looked at and edited. Frames stay in the recordings' files.
///
/// Every command checks what it is given and throws Error, with nothing changed, where the exam could not hold it. A
/// command is one action, which can be undone; those between begin_action and end_action are one action together. An
/// action that in the end changes nothing leaves no trace. Structures, contours and points are numbered from 0.
///
/// To be used from one thread; other threads may work on copies and on the scan, which is never changed.
class Document {
 public:
  /// Opens an exam (its folder or exam.json) or a recording. Throws Error as read_exam, open_scan, read_contours and
  /// require_measurable do. A saved history that does not fit is left out, and messages() says so.
  explicit Document(const std::filesystem::path& path, const DocumentOptions& options = {});
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  // What is open.

  /// The exam as it was opened or saved last; what was edited since is in content(). Without an exam its folder is
  /// empty.
  const Exam& exam() const { return exam_; }
  /// Whether it is an exam in a folder; else it must be saved by save_as first.
  bool has_folder() const { return !exam_.folder.empty(); }
  /// For a window's title: the folder's name, or the recording's.
  std::string title() const;
  /// Without a calibration millimetres are pixels, and nothing may be measured.
  bool is_calibrated() const { return calibrated_; }
  std::shared_ptr<const Scan> scan() const { return scan_; }
  const ExamContent& content() const { return content_; }
  const std::vector<Structure>& structures() const { return content_.structures; }
  const std::string& text(ExamText text) const { return content_.texts[static_cast<std::size_t>(text)]; }
  /// Index of the structure with this id (ExamContent::ids); empty where it is not there any more.
  std::optional<std::size_t> index_of(std::uint64_t id) const;
  /// How sweeps share space, as `fathom measure` would take them; empty where the scan is taken as one sweep. Kept
  /// until it changes. Throws Error as SpacePartition and find_sweeps do.
  const std::optional<Division>& division() const;
  /// Throws Error as division().
  DocumentSnapshot snapshot() const;
  /// What the user must be told of opening and saving, in order.
  const std::vector<std::string>& messages() const { return messages_; }

  // What changed: numbers that grow with every change, also with those undone. Each is one of revision()'s values.

  std::uint64_t revision() const { return revision_; }
  /// Of a structure's outlines and marks; its name, colour and opacity are in revision() alone.
  std::uint64_t structure_revision(std::size_t structure) const { return structure_revisions_.at(structure); }
  /// Of all that the volume of a structure is made of.
  std::uint64_t result_revision(std::size_t structure) const {
    return std::max({structure_revision(structure), division_revision_, placement_revision_});
  }
  /// Of sweeps and dividing planes; of the calibration.
  std::uint64_t division_revision() const { return division_revision_; }
  std::uint64_t placement_revision() const { return placement_revision_; }
  /// Whether there is something to save.
  bool is_modified() const;

  // Actions.

  /// What follows is one action with this name, until end_action. Actions do not nest: an open one is ended.
  void begin_action(std::string name);
  /// Whether it changed anything.
  bool end_action();
  /// Takes back all that was changed since begin_action.
  void cancel_action();
  bool in_action() const { return open_.has_value(); }

  /// Names of what undo and redo would undo and do again; empty where there is nothing. An open action is ended first.
  std::optional<std::string> undo_name() const;
  std::optional<std::string> redo_name() const;
  /// False where there is nothing to undo, or to do again.
  bool undo();
  bool redo();
  const History& history() const { return history_; }

  // Structures.

  /// Adds it at the end, with what it has; returns its index. An empty colour: the next one of a palette.
  std::size_t add_structure(Structure structure);
  void remove_structure(std::size_t structure);
  void rename_structure(std::size_t structure, const std::string& name);
  void recolor_structure(std::size_t structure, const std::string& color);
  /// Of its surface, in [0, 1].
  void set_opacity(std::size_t structure, double opacity);

  // Outlines, at least three points each. Outlining a frame takes away the mark that the structure is absent there, or
  // the extremity.

  /// Returns its index in Structure::contours.
  std::size_t add_contour(std::size_t structure, Contour contour);
  /// Frame and recording must be as before.
  void replace_contour(std::size_t structure, std::size_t contour, Contour by);
  void remove_contour(std::size_t structure, std::size_t contour);
  void move_point(std::size_t structure, std::size_t contour, std::size_t point, const Eigen::Vector2d& to_px);
  /// Before point `before`, or behind the last.
  void insert_point(std::size_t structure, std::size_t contour, std::size_t before, const Eigen::Vector2d& point_px);
  /// Throws Error for one of three points: remove_contour is meant then.
  void remove_point(std::size_t structure, std::size_t contour, std::size_t point);
  void set_closed(std::size_t structure, std::size_t contour, bool closed);

  // Marks. A frame that is outlined can have none: throws Error.

  void set_absent(std::size_t structure, int recording, int frame, bool absent);
  /// Empty: takes it away.
  void set_extremity(std::size_t structure, int recording, int frame, const std::optional<Eigen::Vector2d>& point_px);

  // Sweeps and planes. Where no sweeps are stated those that are found become so first.

  void add_plane(const DividingPlane& plane);
  void move_plane(std::size_t plane, const DividingPlane& to);
  void remove_plane(std::size_t plane);
  /// Planes between all sweeps, by place_dividing_planes, in place of those that are there. Returns its warnings.
  std::vector<std::string> place_planes();
  void split_sweep(std::size_t sweep, int frame);
  void join_sweeps(std::size_t sweep);
  void remove_sweep(std::size_t sweep);
  /// All at once, as they were read or found.
  void set_sweeps(std::vector<Sweep> sweeps);

  void set_text(ExamText text, const std::string& to);

  // What cannot be undone.

  /// Another calibration. Throws Error as read_calibration and open_scan. It is copied into the exam's folder when that
  /// is saved.
  void set_calibration(const std::filesystem::path& file);
  /// Results of the exam as it is now, to be saved with it; dropped at the next change of what they depend on.
  void set_results(const nlohmann::json& results);

  // Saving: by one call, or in three steps of which the second, PendingSave::write, may run beside the main thread.

  /// Throws Error where the document has no folder.
  std::shared_ptr<PendingSave> begin_save();
  /// To make an exam in `folder`, which must not hold one, and go on with that. Recordings and calibration are copied
  /// into the folder, unless they lie there already, so that it can be moved as it is.
  std::shared_ptr<PendingSave> begin_save_as(const std::filesystem::path& folder);
  /// Once it is written. What was edited meanwhile is still to be saved.
  void finish_save(const PendingSave& saved);
  /// exam.json, the contours and the history, all or none. Throws Error as PendingSave::write.
  void save();
  void save_as(const std::filesystem::path& folder, const Progress& progress = {});

  // Work that a crash left behind: to be asked for after opening. A clean end of the document removes its journal.

  /// Empty where there is none, or the exam is open in another window.
  const std::optional<UnsavedWork>& unsaved_work() const { return unsaved_; }
  /// Does it again; it can be undone as before. Throws Error, with nothing changed, where it does not fit.
  void recover();
  void discard_unsaved();
  /// To be called now and then, at least every second: keeps long actions safe, and looks for faults of the disk.
  void poll();

 private:
  void open_exam(const std::filesystem::path& path);
  void open_recording_alone(const std::filesystem::path& path);
  void set_content(std::vector<Structure> structures);
  void change(const char* name, Change change);
  void change_division(const char* name, std::vector<Sweep> sweeps, std::vector<DividingPlane> planes);
  void finish(Edit edit);
  void touch(const Change& change);
  void touch_all();
  const Structure& structure_at(std::size_t structure) const;
  const Contour& contour_at(std::size_t structure, std::size_t contour) const;
  void require_frame(int recording, int frame) const;
  void require_contour(const Contour& contour, std::size_t instead_of) const;
  void require_not_outlined(const Structure& structure, int recording, int frame) const;
  void replace_points(const char* name, std::size_t structure, std::size_t contour, Polygon points_px);
  std::vector<Sweep> stated_sweeps() const;
  Exam exam_to_save() const;
  void load_history();
  void find_unsaved();
  void open_journal();
  void drop_journal();
  void journal(JournalStep step, History::Item edit, std::string text = {});
  void journal_since(const History::Item& state);
  void set_base();

  DocumentOptions options_;
  Exam exam_;
  std::vector<std::filesystem::path> recordings_;  ///< the files
  std::filesystem::path calibration_;              ///< the file; empty: none
  std::shared_ptr<const Scan> scan_;
  bool calibrated_ = false;
  ExamContent content_;
  History history_;
  History::Item saved_;                 ///< History::state when it was saved
  bool unsaved_setup_ = false;          ///< calibration or results changed, which the history does not know
  std::uint64_t setup_ = 0;             ///< grows with them
  std::uint64_t measured_ = 0;          ///< measured_digest that the results are of
  std::optional<Edit> open_;            ///< the action under way
  std::uint64_t outlines_on_disk_ = 0;  ///< outlines_digest of the contours file
  JournalStart base_;                   ///< what is on the disk
  std::shared_ptr<Autosave> autosave_;  ///< empty until something is edited, and where it cannot be kept
  bool autosave_failed_ = false;        ///< said once
  std::optional<UnsavedWork> unsaved_;
  std::chrono::steady_clock::time_point open_kept_;  ///< when the open action was put into the journal last
  std::vector<std::string> messages_;
  std::uint64_t next_id_ = 1;
  std::uint64_t revision_ = 1;
  std::vector<std::uint64_t> structure_revisions_;
  mutable std::uint64_t division_revision_ = 1;  ///< also when outlines make one sweep several, seen by division()
  std::uint64_t placement_revision_ = 1;
  mutable std::optional<Division> division_;
  mutable std::uint64_t division_of_ = 0;  ///< revision that division_ was made at; 0: not made
};

}  // namespace fathom
