#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/progress.h"
#include "exam/anonymous.h"
#include "exam/document.h"
#include "exam/results.h"
#include "surface/mesh.h"

namespace fathom {

struct ReportOptions {
  std::string program;           ///< name and version, "fathom 1.0"
  bool anonymous = false;        ///< without names, dates, notes and names of files
  std::optional<SafeArea> area;  ///< what may be shown of B-scans; anonymous reports show none where it is empty
};

/// Everything that is told or exported of a document, made once.
struct ReportContent {
  std::vector<StructureResult> results;
  std::vector<Mesh> meshes;  ///< one for each structure; without triangles where there is no surface
};

/// Measures, and makes the surfaces. Throws Error as measure_document; Cancelled. A surface that cannot be made is
/// missing; the results' warnings say why.
ReportContent report_content(const DocumentSnapshot& document, const Progress& progress = {});

/// A structure's B-scan in the middle with its outlines, beside all of them in space. Empty where there is nothing to
/// picture, or the B-scan may not be shown.
cv::Mat outlines_picture(const DocumentSnapshot& document, std::size_t structure, const ReportOptions& options);

/// Its surface, without words. Empty where there is none.
cv::Mat surface_picture_of(const DocumentSnapshot& document, std::size_t structure, const Mesh& mesh);

/// The results as text without names of files, where the options ask for it.
std::vector<StructureResult> results_to_show(const DocumentSnapshot& document, const ReportContent& content,
                                             const ReportOptions& options);

/// The report as one HTML page that needs no other file and prints on A4 or Letter: texts, volumes by method, the
/// interval where it is known, areas along the sweeps as a graph and a table, pictures, warnings, versions.
std::string report_html(const DocumentSnapshot& document, const ReportContent& content, const ReportOptions& options);

}  // namespace fathom
