#include "exam/results.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "measurement/contour_surface.h"

namespace fathom {

namespace {

nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

void add_once(std::vector<std::string>& warnings, const std::string& warning) {
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
}

// Fills in the volumes of the surfaces; what prevents one goes to the warnings.
void measure_surfaces(const Structure& structure, const FrameLocator& locator, const Progress& progress,
                      StructureResult& result) {
  struct Method {
    Guide guide;
    GapOrder order;
    std::optional<double>* volume_ml;
  };
  SurfaceVolumes& volumes = result.surfaces;
  const std::array<Method, 4> methods{{{Guide::kDiscs, GapOrder::kLinear, &volumes.disc_guided_ml},
                                       {Guide::kDiscs, GapOrder::kCurved, &volumes.disc_guided_curved_ml},
                                       {Guide::kCentroids, GapOrder::kLinear, &volumes.centroid_guided_ml},
                                       {Guide::kShape, GapOrder::kLinear, &volumes.shape_based_ml}}};
  double done = 0.0;
  for (const Method& method : methods) {
    const double step = 1.0 / static_cast<double>(methods.size());
    ContourSurfaceOptions options;
    options.guide = method.guide;
    options.order = method.order;
    try {
      ContourSurface surface(locator, options);
      surface.update(structure, part_of(progress, done, done + step));
      *method.volume_ml = surface.volume_ml();
      for (const std::string& warning : surface.warnings()) add_once(result.measurement.warnings, warning);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      add_once(result.measurement.warnings, std::string("no surface: ") + error.what());
    }
    done += step;
  }
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
    if (options.surfaces && result.measurement.volumes.linear_ml) {
      const double step = 1.0 / static_cast<double>(structures.size());
      const double done = step * static_cast<double>(results.size());
      measure_surfaces(structure, locator, part_of(progress, done, done + step), result);
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
    const PlanimetryVolumes& volumes = result.measurement.volumes;
    nlohmann::ordered_json item;
    item["name"] = result.name;
    item["sections"] = result.measurement.sections;
    // Every name of the interface is there from the start, so that readers need not ask which version wrote the file.
    item["volume_ml"] = {{"linear_planimetry", number_or_null(volumes.linear_ml)},
                         {"cubic_planimetry", number_or_null(volumes.cubic_ml)},
                         {"cubic_planimetry_3d", number_or_null(volumes.cubic_3d_ml)},
                         {"shape_based", number_or_null(result.surfaces.shape_based_ml)},
                         {"centroid_guided", number_or_null(result.surfaces.centroid_guided_ml)},
                         {"disc_guided", number_or_null(result.surfaces.disc_guided_ml)},
                         {"disc_guided_curved", number_or_null(result.surfaces.disc_guided_curved_ml)}};
    item["volume_interval_ml"] = nullptr;
    item["partitions"] = nlohmann::ordered_json::array();
    item["warnings"] = result.measurement.warnings;
    item["seconds"] = result.seconds;
    structures.push_back(std::move(item));
  }
  return {{"structures", std::move(structures)}};
}

}  // namespace fathom
