#include "exam/results_export.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "measurement/section_outline.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

std::string csv_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string csv_number(const nlohmann::ordered_json& value) { return value.is_number() ? value.dump() : ""; }

// A structure or one of its parts. The interval is that of the structure.
std::string csv_line(const std::string& name, const std::string& sweep, const nlohmann::ordered_json& item) {
  std::string line = csv_text(name) + "," + sweep + "," + csv_number(item["sections"]);
  for (const auto& volume : item["volume_ml"].items()) line += "," + csv_number(volume.value());
  const auto interval = item.find("volume_interval_ml");
  const bool known = interval != item.end() && interval->is_array() && interval->size() == 2;
  for (const std::size_t end : {0U, 1U}) line += "," + (known ? csv_number((*interval)[end]) : std::string());
  std::string warnings;
  for (const auto& warning : item["warnings"]) {
    warnings += (warnings.empty() ? "" : "; ") + warning.get<std::string>();
  }
  return line + "," + csv_text(warnings) + "\r\n";
}

}  // namespace

std::vector<StructureResult> measure_document(const DocumentSnapshot& document, const MeasureOptions& options,
                                              const Progress& progress) {
  const std::string file = document.title;
  if (document.calibration.empty())
    throw Error(file + ": has no calibration, so that nothing can be measured; choose one");
  const Scan& scan = *document.scan;
  const std::vector<Structure>& structures = document.structures;
  const std::optional<Division>& division = document.division;
  const bool divided = division && !division->partition.planes().empty();
  require_simple_outlines(structures, file);
  require_measurable(structures, frame_counts(scan), divided ? OpenContours::kAllow : OpenContours::kRefuse, file);
  MeasureOptions asked = options;
  if (!asked.confidence) asked.confidence = ConfidenceOptions{scan.calibration, scan.names, {}};
  if (division) return measure_structures(structures, scan, *division, asked, progress);
  return measure_structures(structures, *scan.recordings.front(), scan.locators.front(), asked, progress);
}

std::string results_csv(const std::vector<StructureResult>& results) {
  const nlohmann::ordered_json json = results_json(results);
  std::string text = "structure,sweep,sections";
  // The same methods for all.
  const nlohmann::ordered_json names = results_json({StructureResult{}})["structures"][0]["volume_ml"];
  for (const auto& volume : names.items()) text += "," + volume.key() + "_ml";
  text += ",interval_low_ml,interval_high_ml,warnings\r\n";
  for (const auto& item : json["structures"]) {
    const std::string name = item["name"].get<std::string>();
    text += csv_line(name, "", item);
    for (const auto& part : item["partitions"]) {
      text += csv_line(name, std::to_string(part["sweep"].get<std::size_t>() + 1), part);
    }
  }
  return text;
}

std::vector<SectionRow> section_rows(const Structure& structure, const Scan& scan,
                                     const std::optional<Division>& division) {
  std::vector<Sweep> sweeps{{0, 0, std::numeric_limits<int>::max()}};
  if (division) sweeps = division->sweeps;
  std::vector<SectionRow> rows;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const Structure here = part_in_sweep(structure, sweeps[s]);
    double along_mm = 0.0;
    std::optional<Eigen::Vector3d> before;
    for (const CrossSection& section : cross_sections(here, scan.locators[sweeps[s].recording], nullptr)) {
      if (before) along_mm += (section.centroid_mm - *before).norm();
      before = section.centroid_mm;
      rows.push_back(
          {s, static_cast<int>(sweeps[s].recording), section.frame, section.vector_area_mm2.norm() / 100.0, along_mm});
    }
  }
  return rows;
}

}  // namespace fathom
