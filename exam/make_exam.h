#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "exam/exam.h"

namespace fathom {

/// What is to be put into an exam. Files may lie anywhere: those outside the exam's folder are copied into it, under a
/// free name where theirs is taken. What is empty stays as it is.
struct ExamParts {
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path calibration;
  std::filesystem::path contours;
  std::optional<std::string> contours_text;  ///< of a contours file, in place of `contours`
  std::optional<std::string> history_text;   ///< of a history file
  std::optional<std::string> patient;
  std::optional<std::string> operator_name;
  std::optional<std::string> date;
  std::optional<std::string> notes;
};

/// Makes an exam in `folder`, which may hold files already, but no exam. A recording in several files becomes one .mha.
/// Nothing is left behind where it throws: Error when a part cannot be read, recordings and calibration do not go
/// together, contours stand on frames that there are not, or the folder holds an exam; Cancelled.
Exam create_exam(const std::filesystem::path& folder, const ExamParts& parts, const Progress& progress = {});

/// The same of an exam that has all but its files, with the folder where it is to be: recordings, calibration and
/// contours are those of `parts`; the rest of `exam` stays, its results too.
Exam create_exam(Exam exam, const ExamParts& parts, const Progress& progress = {});

/// Adds recordings to an exam and replaces what else is given. No file of the folder is removed or changed but
/// exam.json. Throws Error as create_exam.
Exam update_exam(Exam exam, const ExamParts& parts, const Progress& progress = {});

}  // namespace fathom
