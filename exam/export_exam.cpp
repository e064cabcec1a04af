#include "exam/export_exam.h"

#include <algorithm>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/staged_folder.h"
#include "core/text_file.h"
#include "exam/report_picture.h"
#include "exam/results_export.h"
#include "exam/structure_files.h"
#include "registration/calibration.h"

namespace fathom {

namespace {

constexpr double kMeasured = 0.5;  // of the progress
constexpr double kPictured = 0.7;

void write_copy(const DocumentSnapshot& document, const std::vector<StructureResult>& results,
                const std::filesystem::path& folder, const ReportOptions& options, const Progress& progress) {
  std::filesystem::create_directories(folder);
  Exam copy = options.anonymous ? without_names(document.exam) : document.exam;
  copy.folder = folder;
  copy.document = nullptr;
  copy.recordings.clear();
  const std::size_t count = document.scan->recordings.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Recording& recording = *document.scan->recordings[i];
    copy.recordings.push_back("recording-" + std::to_string(i + 1) + ".mha");
    const Progress here = part_of(progress, static_cast<double>(i) / static_cast<double>(count),
                                  static_cast<double>(i + 1) / static_cast<double>(count));
    if (options.anonymous) {
      write_recording(MaskedRecording(recording, *options.area, "recording"), folder / copy.recordings.back(), {},
                      here);
    } else {
      write_recording(recording, folder / copy.recordings.back(), {}, here);
    }
  }
  Calibration calibration = read_calibration(document.calibration);
  if (options.anonymous) calibration.probe = calibration.date = {};
  copy.calibration = "calibration.json";
  write_text_file(folder / copy.calibration, calibration_json(calibration));
  copy.structures = "contours.json";
  write_text_file(folder / copy.structures, contours_json(document.structures));
  copy.results = nlohmann::json::parse(results_json(results).dump());
  write_exam(copy);
}

}  // namespace

std::vector<std::string> export_exam(const DocumentSnapshot& document, const std::filesystem::path& folder,
                                     const ExportOptions& options, const Progress& progress) {
  if (options.recordings && options.report.anonymous && !options.report.area) {
    throw Error(document.title +
                ": which part of the images is free of names was not said; name it, or leave the "
                "recordings out");
  }
  StagedFolder staged(folder);
  const ReportContent content = report_content(document, part_of(progress, 0.0, kMeasured));
  const std::vector<StructureResult> results = results_to_show(document, content, options.report);
  std::vector<std::string> names;
  const auto place = [&](const std::filesystem::path& file) {
    names.push_back(file.filename().string());
    return staged.path() / file;
  };
  write_text_file(place("results.json"), results_json(results).dump(1, ' ') + "\n");
  write_text_file(place("results.csv"), results_csv(results));
  write_text_file(place("report.html"), report_html(document, content, options.report));
  const auto meshes = structure_files("surface" + options.mesh_extension, document.structures);
  const auto surfaces = structure_files("surface.png", document.structures);
  const auto outlines = structure_files("outlines.png", document.structures);
  for (std::size_t i = 0; i < document.structures.size(); ++i) {
    report(progress, kMeasured);
    if (!content.meshes[i].triangles.empty()) {
      AtomicFile file(place(meshes[i]));
      write_structure_mesh(content.meshes[i], document.structures[i], file, {});
      file.commit();
      write_png(surface_picture_of(document, i, content.meshes[i]), place(surfaces[i]));
    }
    const cv::Mat picture = outlines_picture(document, i, options.report);
    if (!picture.empty()) write_png(picture, place(outlines[i]));
  }
  if (options.recordings) {
    write_copy(document, results, place("exam"), options.report, part_of(progress, kPictured, 1.0));
  }
  staged.commit("report.html");
  report(progress, 1.0);
  return names;
}

}  // namespace fathom
