#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "registration/partition.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"

namespace fathom {

/// The texts of an exam.
enum class ExamText { kPatient, kOperator, kDate, kNotes };
constexpr std::size_t kExamTexts = 4;

/// What of an exam can be edited, and undone.
struct ExamContent {
  /// Contours, extremities and marks by recording and frame, those of one frame in the order in which they were drawn:
  /// the order of the contours file.
  std::vector<Structure> structures;
  std::vector<std::uint64_t> ids;  ///< one for each structure, the same as long as the document is open, also undone
  std::vector<Sweep> sweeps;       ///< as stated; empty: those that are found
  std::vector<DividingPlane> planes;
  std::array<std::string, kExamTexts> texts;  ///< by ExamText
};

/// Puts contours, extremities and marks into the order of ExamContent::structures.
void put_in_order(Structure& structure);

/// A number that differs, as far as 64 bits can, where the saved files would: FNV-1a over their texts.
std::uint64_t content_digest(const ExamContent& content);
/// The same as sixteen hexadecimal digits, for files.
std::string digest_text(const ExamContent& content);
/// The same of the outlines alone, with names and colours.
std::uint64_t outlines_digest(const ExamContent& content);
/// The same of what volumes depend on: without the texts, names and colours.
std::uint64_t measured_digest(const ExamContent& content);

/// One item of a structure that was put in (`before` empty), taken out (`after` empty) or replaced.
template <typename Item>
struct ItemChange {
  std::size_t structure = 0;  ///< index at that time
  std::size_t index = 0;      ///< in the structure's list of such items
  std::optional<Item> before;
  std::optional<Item> after;
};

/// A structure put in or taken out, with all that it has.
struct StructureChange {
  std::size_t index = 0;
  std::uint64_t id = 0;
  std::optional<Structure> before;
  std::optional<Structure> after;
};

struct StructureStyle {
  std::string name;
  std::string color;
  double opacity = kUsualOpacity;
  bool operator==(const StructureStyle&) const = default;
};

struct StyleChange {
  std::size_t structure = 0;
  StructureStyle before;
  StructureStyle after;
};

struct DivisionChange {
  std::vector<Sweep> sweeps_before;
  std::vector<Sweep> sweeps_after;
  std::vector<DividingPlane> planes_before;
  std::vector<DividingPlane> planes_after;
};

struct TextChange {
  ExamText text = ExamText::kPatient;
  std::string before;
  std::string after;
};

using Change = std::variant<ItemChange<Contour>, ItemChange<Extremity>, ItemChange<AbsentMark>, StructureChange,
                            StyleChange, DivisionChange, TextChange>;

/// One action of the user.
struct Edit {
  std::string name;  ///< "Move point", for the menu
  std::vector<Change> changes;
};

enum class Direction { kDo, kUndo };

/// Does or undoes a change. Returns false, with `content` as it was, where the change does not fit: what it would
/// replace or take out is not there.
[[nodiscard]] bool apply(const Change& change, Direction direction, ExamContent& content);

/// The same with all changes, in their order or backward; on false some of them may have been made.
[[nodiscard]] bool apply(const Edit& edit, Direction direction, ExamContent& content);

/// Whether a change leaves everything as it was.
bool is_nothing(const Change& change);

/// Adds a change that was made after all of the edit's. Where it goes on changing what one of them changed, as in a
/// drag, both become one, or none where they undo each other.
void add_change(Change change, Edit& edit);

/// Memory that an edit takes, in bytes.
std::size_t size_bytes(const Edit& edit);

}  // namespace fathom
