#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/laboratory/study_results.h"

namespace fathom {

/// A study's rows and report, made of results that are complete. Throws Error, naming the file that they come from,
/// where the values are not those of the study.
nlohmann::ordered_json study_rows(const StudyResults& results);
StudyReport study_report(const StudyResults& results);

/// Throws Error unless these are the results of a study as this program of this version has it.
void require_current(const StudyResults& results, const std::string& version);

/// Writes a folder of studies, all files or none: the results; of complete ones tables (text and CSV), plots (SVG),
/// pictures (PNG), and for all complete studies in the folder, also those that were there before, a page (index.html)
/// and its tables in Markdown (results.md).
class LaboratoryFolder {
 public:
  /// Throws Error when nothing can be written there, so that it is known before the work.
  LaboratoryFolder(const std::filesystem::path& folder, std::string version);
  ~LaboratoryFolder();
  LaboratoryFolder(const LaboratoryFolder&) = delete;
  LaboratoryFolder& operator=(const LaboratoryFolder&) = delete;

  /// Returns what the user must know: why there are no plots, which files in the folder are not on the page.
  /// Throws Error.
  std::vector<std::string> write(const std::vector<StudyResults>& results);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The files of results that a user names: files as they are, folders for all "*.json" in them. Throws Error when a
/// folder has none, or a name is neither.
std::vector<std::filesystem::path> results_files(const std::vector<std::string>& names);

}  // namespace fathom
