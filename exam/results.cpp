#include "exam/results.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "core/error.h"
#include "exam/divided_confidence.h"

namespace fathom {

namespace {

nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

void add_once(std::vector<std::string>& warnings, const std::string& warning) {
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
}

nlohmann::ordered_json volumes_json(const PlanimetryVolumes& volumes, const SurfaceVolumes& surfaces) {
  // Every name of the interface is there from the start, so that readers need not ask which version wrote the file.
  return {{"linear_planimetry", number_or_null(volumes.linear_ml)},
          {"cubic_planimetry", number_or_null(volumes.cubic_ml)},
          {"cubic_planimetry_3d", number_or_null(volumes.cubic_3d_ml)},
          {"cubic_planimetry_quadric", number_or_null(volumes.quadric_ml)},
          {"shape_based", number_or_null(surfaces.shape_based_ml)},
          {"centroid_guided", number_or_null(surfaces.centroid_guided_ml)},
          {"disc_guided", number_or_null(surfaces.disc_guided_ml)},
          {"disc_guided_curved", number_or_null(surfaces.disc_guided_curved_ml)}};
}

nlohmann::ordered_json part_json(const PartResult& part) {
  return {{"sweep", part.sweep},
          {"region", part.region},
          {"sections", part.measurement.sections},
          {"volume_ml", volumes_json(part.measurement.volumes, part.surfaces)},
          {"loss_ml", number_or_null(part.missing_ml)},
          {"loss", part.loss.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(part.loss)},
          {"warnings", part.measurement.warnings}};
}

// What a structure has on one recording, as if there were no other.
Structure on_recording(const Structure& structure, std::size_t recording) {
  return part_in_sweep(structure, {recording, 0, std::numeric_limits<int>::max()});
}

// The surfaces of whole sweeps, each by itself.
void measure_sweep_surfaces(const Structure& structure, const Scan& scan, const Division& division,
                            const Progress& progress, StructureResult& result) {
  double done = 0.0;
  for (PartResult& part : result.partitions) {
    const double step = 1.0 / static_cast<double>(result.partitions.size());
    const Sweep& sweep = division.sweeps[part.sweep];
    std::vector<std::string> warnings;
    if (part.measurement.volumes.linear_ml) {
      part.surfaces = surface_volumes(part_in_sweep(structure, sweep), scan.locators[sweep.recording],
                                      part_of(progress, done, done + step), warnings);
    }
    for (const std::string& warning : warnings) {
      add_once(part.measurement.warnings, warning);
      add_once(result.measurement.warnings, "sweep " + std::to_string(part.sweep + 1) + ": " + warning);
    }
    done += step;
  }
  if (result.partitions.size() == 1) result.surfaces = result.partitions.front().surfaces;
}

// The surfaces of all parts of space. Warnings that tell of outlines are there from planimetry already.
void measure_part_surfaces(const Structure& structure, const Scan& scan, const Division& division,
                           const Progress& progress, StructureResult& result) {
  std::vector<std::string> warnings;
  const DividedSurfaceVolumes volumes = surface_volumes(structure, scan.locators, division, progress, warnings);
  result.surfaces = volumes.total;
  for (PartResult& part : result.partitions) {
    const auto found = volumes.by_region.find(part.region);
    if (found != volumes.by_region.end()) part.surfaces = found->second;
  }
  for (const std::string& warning : warnings) add_once(result.measurement.warnings, "surface: " + warning);
}

}  // namespace

std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Recording& recording,
                                                const FrameLocator& locator, const MeasureOptions& options,
                                                const Progress& progress) {
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
    if (options.confidence) {
      result.confidence = confidence(structure, sections, recording, locator, *options.confidence);
    }
    if (options.surfaces && result.measurement.volumes.linear_ml) {
      const double step = 1.0 / static_cast<double>(structures.size());
      const double done = step * static_cast<double>(results.size());
      result.surfaces =
          surface_volumes(structure, locator, part_of(progress, done, done + step), result.measurement.warnings);
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    results.push_back(std::move(result));
  }
  report(progress, 1.0);
  return results;
}

StructureResult division_result(const Structure& structure, const Scan& scan, const Division& division,
                                PartitionedVolume measured) {
  const bool divided = !division.partition.planes().empty();
  StructureResult result;
  result.name = structure.name;
  std::vector<std::string>& warnings = result.measurement.warnings;
  for (std::size_t i = 0; i < scan.recordings.size(); ++i) {
    const RecordingHeader& header = scan.recordings[i]->header();
    if (!header.has_images()) continue;
    const auto warning = outside_image_warning(on_recording(structure, i), header.width, header.height);
    if (warning) warnings.push_back(*warning);
  }
  warnings.insert(warnings.end(), measured.warnings.begin(), measured.warnings.end());
  result.measurement.volumes = measured.total;
  for (PartitionVolume& part : measured.partitions) {
    result.measurement.sections += part.measurement.sections;
    result.partitions.push_back({part.region,
                                 part.sweep,
                                 std::move(part.measurement),
                                 {},
                                 divided ? std::optional(part.missing_ml) : std::nullopt,
                                 std::move(part.loss)});
  }
  if (result.partitions.empty()) warnings.push_back("no outline lies in a sweep: no volume; outline the structure");
  return result;
}

std::vector<StructureResult> measure_structures(const std::vector<Structure>& structures, const Scan& scan,
                                                const Division& division, const MeasureOptions& options,
                                                const Progress& progress) {
  const bool divided = !division.partition.planes().empty();
  std::vector<StructureResult> results;
  for (const Structure& structure : structures) {
    const auto start = std::chrono::steady_clock::now();
    const double step = 1.0 / static_cast<double>(structures.size());
    const double done = step * static_cast<double>(results.size());
    StructureResult result =
        division_result(structure, scan, division,
                        divided ? measure_partitions(structure, scan.locators, division.sweeps, division.partition)
                                : measure_sweeps(structure, scan.locators, division.sweeps));
    if (divided && options.confidence) {
      result.confidence = divided_confidence(structure, scan, division, options.confidence->errors);
    }
    if (options.surfaces && !result.partitions.empty()) {
      const auto measure_part = divided ? measure_part_surfaces : measure_sweep_surfaces;
      measure_part(structure, scan, division, part_of(progress, done, done + step), result);
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    results.push_back(std::move(result));
  }
  report(progress, 1.0);
  return results;
}

nlohmann::ordered_json results_json(const std::vector<StructureResult>& results) {
  nlohmann::ordered_json structures = nlohmann::ordered_json::array();
  for (const StructureResult& result : results) {
    nlohmann::ordered_json item;
    item["name"] = result.name;
    item["sections"] = result.measurement.sections;
    item["volume_ml"] = volumes_json(result.measurement.volumes, result.surfaces);
    item["recommended"] = kRecommendedKey;
    add_confidence(result.confidence, item);
    item["partitions"] = nlohmann::ordered_json::array();
    for (const PartResult& part : result.partitions) item["partitions"].push_back(part_json(part));
    item["warnings"] = result.measurement.warnings;
    item["seconds"] = result.seconds;
    structures.push_back(std::move(item));
  }
  return {{"structures", std::move(structures)}};
}

}  // namespace fathom
