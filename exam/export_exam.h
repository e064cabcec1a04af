#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "exam/exam_report.h"

namespace fathom {

struct ExportOptions {
  ReportOptions report;
  std::string mesh_extension = ".ply";
  bool recordings = false;  ///< a copy of the exam as well, in the folder "exam"
};

/// Puts everything that was measured into a folder, all or nothing: results.json, results.csv, report.html, and for
/// each structure surface.ply, outlines.png and surface.png, as far as there are any. Files of the same names are
/// replaced. An anonymous copy of the exam has masked recordings of new names, and neither history nor free texts.
/// Returns the names of what was written. Throws Error as report_content; where recordings are to be anonymous and no
/// area is named; Cancelled.
std::vector<std::string> export_exam(const DocumentSnapshot& document, const std::filesystem::path& folder,
                                     const ExportOptions& options, const Progress& progress = {});

}  // namespace fathom
