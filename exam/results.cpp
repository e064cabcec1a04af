#include "exam/results.h"

#include <chrono>

namespace fathom {

namespace {

nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Recording& recording,
                                                const FrameLocator& locator) {
  const RecordingHeader& header = recording.header();
  std::vector<StructureResult> results;
  for (const Structure& structure : structures) {
    const auto start = std::chrono::steady_clock::now();
    StructureResult result;
    result.name = structure.name;
    std::vector<std::string> warnings;
    if (header.has_images()) {
      const auto warning = outside_image_warning(structure, header.width, header.height);
      if (warning) warnings.push_back(*warning);
    }
    const std::vector<CrossSection> sections = cross_sections(structure, locator, &warnings);
    result.measurement = measure_planimetry(sections);
    result.measurement.warnings.insert(result.measurement.warnings.begin(), warnings.begin(), warnings.end());
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    results.push_back(std::move(result));
  }
  return results;
}

nlohmann::ordered_json results_json(const std::vector<StructureResult>& results) {
  nlohmann::ordered_json structures = nlohmann::ordered_json::array();
  for (const StructureResult& result : results) {
    const PlanimetryVolumes& volumes = result.measurement.volumes;
    nlohmann::ordered_json item;
    item["name"] = result.name;
    item["sections"] = result.measurement.sections;
    // Every name of the interface is there from the start, so that readers need not ask which version wrote the file.
    item["volume_ml"] = {{"linear_planimetry", number_or_null(volumes.linear_ml)},
                         {"cubic_planimetry", number_or_null(volumes.cubic_ml)},
                         {"cubic_planimetry_3d", number_or_null(volumes.cubic_3d_ml)},
                         {"shape_based", nullptr},
                         {"centroid_guided", nullptr},
                         {"disc_guided", nullptr}};
    item["volume_interval_ml"] = nullptr;
    item["partitions"] = nlohmann::ordered_json::array();
    item["warnings"] = result.measurement.warnings;
    item["seconds"] = result.seconds;
    structures.push_back(std::move(item));
  }
  return {{"structures", std::move(structures)}};
}

}  // namespace fathom
