#include "exam/exam_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Core>
#include <opencv2/core/version.hpp>

#include "core/error.h"
#include "core/html.h"
#include "exam/area_graph.h"
#include "exam/html.h"
#include "exam/report_picture.h"
#include "exam/results_export.h"
#include "exam/surface_picture.h"
#include "measurement/contour_surface.h"
#include "measurement/partition_surface.h"
#include "measurement/section_outline.h"

namespace fathom {

namespace {

constexpr const char* kStyle = R"(
body { font: 11pt/1.4 sans-serif; color: #111; background: #fff; max-width: 190mm; margin: 10mm auto; padding: 0 5mm; }
h1 { font-size: 17pt; margin: 0 0 3mm; } h2 { font-size: 13pt; margin: 7mm 0 2mm; border-bottom: 1px solid #888; }
table { border-collapse: collapse; margin: 2mm 0; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid #bbb; padding: 0.6mm 2.5mm; text-align: right; }
th:first-child, td:first-child { text-align: left; } th { background: #eee; }
img, svg { max-width: 100%; margin: 2mm 0; } svg { height: auto; display: block; } .warning { margin: 1mm 0; padding-left: 4mm; border-left: 2mm solid #d80; }
.notes { white-space: pre-wrap; } footer { margin-top: 8mm; font-size: 9pt; color: #555; }
@page { margin: 15mm; }
@media print {
  body { margin: 0; padding: 0; max-width: none; } h2 { break-after: avoid; } thead { display: table-header-group; }
  tr, img, svg, .warning { break-inside: avoid; } th, svg { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

// The methods of results_json, for people.
constexpr std::array<std::pair<const char*, const char*>, 8> kMethods{{
    {kRecommendedKey, kRecommendedMethod},
    {"cubic_planimetry", "cubic planimetry"},
    {"linear_planimetry", "linear planimetry"},
    {"cubic_planimetry_3d", "cubic planimetry, 3D"},
    {"disc_guided_curved", "surface, disc-guided, curved"},
    {"disc_guided", "surface, disc-guided"},
    {"centroid_guided", "surface, centroid-guided"},
    {"shape_based", "surface, shape-based"},
}};

std::string number(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string ml(const nlohmann::ordered_json& value) {
  return value.is_number() ? number(value.get<double>(), 2) : "\u2013";
}

std::string method_name(const std::string& key) {
  for (const auto& [known, name] : kMethods) {
    if (key == known) return name;
  }
  return key;
}

// Nothing where no structure has one.
void add_intervals(const nlohmann::ordered_json& results, std::vector<std::vector<std::string>>& rows) {
  std::vector<std::string> row{"its 95 % interval"};
  bool known = false;
  for (const auto& item : results["structures"]) {
    const auto& interval = item["volume_interval_ml"];
    const bool has = interval.is_array() && interval.size() == 2;
    known = known || has;
    row.push_back(has ? ml(interval[0]) + " to " + ml(interval[1]) : "\u2013");
  }
  if (known) rows.push_back(std::move(row));
}

// Methods in rows, structures in columns; the number to quote comes first.
std::string volumes_table(const nlohmann::ordered_json& results) {
  std::vector<std::vector<std::string>> rows{{"volume (ml)"}};
  for (const auto& item : results["structures"]) rows[0].push_back(item["name"].get<std::string>());
  std::vector<std::string> keys;
  for (const auto& method : kMethods) keys.emplace_back(method.first);
  for (const auto& volume : results["structures"][0]["volume_ml"].items()) {
    if (method_name(volume.key()) == volume.key()) keys.push_back(volume.key());
  }
  for (const std::string& key : keys) {
    rows.push_back({method_name(key)});
    for (const auto& item : results["structures"])
      rows.back().push_back(ml(item["volume_ml"].value(key, nlohmann::ordered_json())));
    if (key == kRecommendedKey) add_intervals(results, rows);
  }
  rows.push_back({"sections"});
  for (const auto& item : results["structures"]) rows.back().push_back(std::to_string(item["sections"].get<int>()));
  return html_table(rows);
}

std::string parts_table(const nlohmann::ordered_json& item) {
  if (item["partitions"].empty()) return {};
  std::vector<std::vector<std::string>> rows{
      {"sweep", "sections", std::string(kRecommendedMethod) + " (ml)", "surface (ml)", "missing (ml)"}};
  for (const auto& part : item["partitions"]) {
    rows.push_back({std::to_string(part["sweep"].get<std::size_t>() + 1), std::to_string(part["sections"].get<int>()),
                    ml(part["volume_ml"][kRecommendedKey]), ml(part["volume_ml"]["disc_guided_curved"]),
                    ml(part["loss_ml"])});
  }
  return html_table(rows);
}

std::string sections_table(const std::vector<SectionRow>& sections) {
  std::vector<std::vector<std::string>> rows{
      {"sweep", "recording", "frame", "along the sweep (mm)", "area (cm\u00b2)"}};
  for (const SectionRow& row : sections) {
    rows.push_back({std::to_string(row.sweep + 1), std::to_string(row.recording + 1), std::to_string(row.frame),
                    number(row.along_mm, 1), number(row.area_cm2, 2)});
  }
  return rows.size() > 1 ? html_table(rows) : std::string();
}

std::string texts_table(const Exam& exam) {
  const std::array<std::pair<const std::string*, const char*>, 3> rows{
      {{&exam.patient, "Patient"}, {&exam.operator_name, "Operator"}, {&exam.date, "Date"}}};
  std::string html;
  for (const auto& [text, name] : rows) {
    if (!text->empty()) html += std::string(name) + ": " + html_text(*text) + "<br>\n";
  }
  if (!html.empty()) html = "<p>" + html + "</p>\n";
  return exam.notes.empty() ? html : html + "<p class=\"notes\">" + html_text(exam.notes) + "</p>\n";
}

std::string versions(const ReportOptions& options) {
  return "<footer>" + html_text(options.program) + " \u00b7 OpenCV " CV_VERSION " \u00b7 Eigen " +
         std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION) +
         " \u00b7 volumes by hand-drawn or assisted outlines; not for diagnosis "
         "without a physician's judgement</footer>\n";
}

// The outline in the middle of all, by frames.
const Contour* middle_contour(const Structure& structure) {
  return structure.contours.empty() ? nullptr : &structure.contours[structure.contours.size() / 2];
}

Mesh mesh_of(const DocumentSnapshot& document, const Structure& structure, const Progress& progress) {
  const auto& division = document.division;
  if (!division) {
    ContourSurface surface(document.scan->locators.front(), {});
    return surface.update(structure, progress);
  }
  return partition_surface(structure, document.scan->locators, *division, {}, Caps::kClosed, progress).mesh();
}

}  // namespace

ReportContent report_content(const DocumentSnapshot& document, const Progress& progress) {
  ReportContent content;
  content.results = measure_document(document, {}, part_of(progress, 0.0, 0.7));
  const double step = 0.3 / static_cast<double>(std::max<std::size_t>(1, document.structures.size()));
  for (const Structure& structure : document.structures) {
    const double done = 0.7 + step * static_cast<double>(content.meshes.size());
    Mesh mesh;
    try {
      mesh = mesh_of(document, structure, part_of(progress, done, done + step));
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      auto& warnings = content.results[content.meshes.size()].measurement.warnings;
      const std::string warning = std::string("no surface: ") + error.what();
      if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
    }
    content.meshes.push_back(std::move(mesh));
  }
  return content;
}

cv::Mat outlines_picture(const DocumentSnapshot& document, std::size_t structure, const ReportOptions& options) {
  const Structure& of = document.structures[structure];
  const Contour* middle = middle_contour(of);
  if (!middle || (options.anonymous && !options.area)) return {};
  const auto number = static_cast<std::size_t>(middle->recording);
  const Recording& recording = *document.scan->recordings[number];
  if (!recording.header().has_images()) return {};
  const Structure here = part_in_sweep(of, {number, 0, std::numeric_limits<int>::max()});
  try {
    if (!options.area) {
      return report_picture(recording, document.scan->locators[number], {here}, middle->frame, {});
    }
    const MaskedRecording masked(recording, *options.area, "recording");
    return report_picture(masked, document.scan->locators[number], {here}, middle->frame, {});
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return {};  // no outlined frame has a pose: the warnings say so
  }
}

cv::Mat surface_picture_of(const DocumentSnapshot& document, std::size_t structure, const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  Structure drawn = document.structures[structure];
  // Of several recordings the picture knows one.
  if (document.scan->recordings.size() > 1) drawn.contours.clear();
  return surface_picture({mesh}, document.scan->locators.front(), {drawn}, {});
}

std::vector<StructureResult> results_to_show(const DocumentSnapshot& document, const ReportContent& content,
                                             const ReportOptions& options) {
  std::vector<StructureResult> results = content.results;
  if (!options.anonymous) return results;
  const auto clean = [&](std::string& text) { text = without_file_names(std::move(text), document); };
  for (StructureResult& result : results) {
    for (std::string& warning : result.measurement.warnings) clean(warning);
    for (PartResult& part : result.partitions) {
      clean(part.loss);
      for (std::string& warning : part.measurement.warnings) clean(warning);
    }
  }
  return results;
}

std::string report_html(const DocumentSnapshot& document, const ReportContent& content, const ReportOptions& options) {
  const nlohmann::ordered_json results = results_json(results_to_show(document, content, options));
  const std::string title = options.anonymous ? "Examination" : "Examination " + document.title;
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>" + html_text(title) +
                     "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" + html_text(title) + "</h1>\n";
  if (!options.anonymous) html += texts_table(document.exam);
  if (results["structures"].empty()) html += "<p>Nothing is outlined yet.</p>\n";
  if (!results["structures"].empty()) html += "<h2>Volumes</h2>\n" + volumes_table(results);
  for (std::size_t i = 0; i < content.results.size(); ++i) {
    const auto& item = results["structures"][i];
    const std::string name = item["name"].get<std::string>();
    html += "<h2>" + html_text(name) + "</h2>\n";
    for (const auto& warning : item["warnings"]) {
      html += "<p class=\"warning\">" + html_text(warning.get<std::string>()) + "</p>\n";
    }
    for (const MissingEnd& end : content.results[i].confidence.missing_ends) {
      html += "<p class=\"warning\">" + html_text(warning_of(end)) + "</p>\n";
    }
    const cv::Mat outlines = outlines_picture(document, i, options);
    if (!outlines.empty()) html += html_picture(outlines, name + ": outlines");
    if (outlines.empty() && options.anonymous && !options.area) {
      html += "<p>B-scans are left out: which part of them is free of names was not said.</p>\n";
    }
    const cv::Mat surface = surface_picture_of(document, i, content.meshes[i]);
    if (!surface.empty()) html += html_picture(surface, name + ": surface");
    const std::vector<SectionRow> sections = section_rows(document.structures[i], *document.scan, document.division);
    html += area_graph_svg(sections, document.structures[i].color) + parts_table(item) + sections_table(sections);
  }
  return html + versions(options) + "</body></html>\n";
}

}  // namespace fathom
