#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "registration/partition.h"
#include "registration/sweep.h"

namespace fathom {

/// The file of an exam's folder that holds what can be undone (docs/file-formats.md).
constexpr const char* kHistoryFile = "history.json";

/// One examination: a folder with `exam.json` and the files that it names (docs/file-formats.md).
struct Exam {
  std::filesystem::path folder;
  std::vector<std::string> recordings;  ///< this and the other files: paths inside `folder`, never out of it
  std::string calibration;              ///< empty where there is none yet
  std::string structures;               ///< the contours file; empty where there is none yet
  std::vector<Sweep> sweeps;            ///< `recording` is an index into `recordings`; none shares frames
  std::vector<DividingPlane> dividing_planes;
  nlohmann::json results;  ///< null where nothing was measured yet
  std::string patient;
  std::string operator_name;
  std::string date;
  std::string notes;
  nlohmann::json document;  ///< exam.json as it was read, from which write_exam keeps what is not above
};

/// Whether `path` is a folder with an exam.json, or such a file.
bool is_exam(const std::filesystem::path& path);

/// The file that describes an exam.
std::filesystem::path exam_json(const Exam& exam);

/// Reads the exam in a folder, or the exam.json named. Throws Error when it is damaged: wrong types, no recording, one
/// named twice, a file outside the folder (absolute, by "..", by a symbolic link), a sweep of a recording that it does
/// not have; and as planes_of. Whether the files are there is seen when they are opened.
Exam read_exam(const std::filesystem::path& path);

/// The path of a file that an exam names. Throws Error, naming exam.json, when it is missing or outside the folder.
std::filesystem::path file_of(const Exam& exam, const std::string& name);

/// Sets sweeps and planes. Where they change, the results are dropped: they were measured with others.
void set_division(Exam& exam, std::vector<Sweep> sweeps, std::vector<DividingPlane> planes);

/// The text of exam.json, keys in alphabetical order. Keys of `document` that are not Fathom's are kept, as are the
/// members of sweeps and planes that did not change.
std::string exam_text(const Exam& exam);

/// Replaces exam.json, whole or not at all. Throws Error.
void write_exam(const Exam& exam);

}  // namespace fathom
