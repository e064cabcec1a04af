#include "exam/surface_volumes.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/error.h"
#include "measurement/contour_surface.h"
#include "measurement/partition_surface.h"

namespace fathom {

namespace {

struct Method {
  Guide guide;
  GapOrder order;
  std::optional<double> SurfaceVolumes::*volume_ml;
};

constexpr std::array<Method, 4> kMethods{{{Guide::kDiscs, GapOrder::kLinear, &SurfaceVolumes::disc_guided_ml},
                                          {Guide::kDiscs, GapOrder::kCurved, &SurfaceVolumes::disc_guided_curved_ml},
                                          {Guide::kCentroids, GapOrder::kLinear, &SurfaceVolumes::centroid_guided_ml},
                                          {Guide::kShape, GapOrder::kLinear, &SurfaceVolumes::shape_based_ml}}};

void add_once(std::vector<std::string>& warnings, const std::string& warning) {
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
}

// make(options, method, progress) returns the surface's warnings.
template <typename Make>
void for_each_method(const Progress& progress, std::vector<std::string>& warnings, const Make& make) {
  double done = 0.0;
  for (const Method& method : kMethods) {
    const double step = 1.0 / static_cast<double>(kMethods.size());
    ContourSurfaceOptions options;
    options.guide = method.guide;
    options.order = method.order;
    try {
      for (const std::string& warning : make(options, method, part_of(progress, done, done + step))) {
        add_once(warnings, warning);
      }
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      add_once(warnings, std::string("no surface: ") + error.what());
    }
    done += step;
  }
}

// A region may have several parts; it has a volume where all of them do.
void add_parts(const PartitionedSurface& surface, const Method& method, DividedSurfaceVolumes& volumes) {
  std::set<std::size_t> unknown;
  for (const PartSurface& part : surface.parts) {
    std::optional<double>& volume_ml = volumes.by_region[part.region].*method.volume_ml;
    if (!part.volume_ml) unknown.insert(part.region);
    volume_ml = volume_ml.value_or(0.0) + part.volume_ml.value_or(0.0);
  }
  for (const std::size_t region : unknown) volumes.by_region[region].*method.volume_ml = std::nullopt;
}

}  // namespace

SurfaceVolumes surface_volumes(const Structure& structure, const FrameLocator& locator, const Progress& progress,
                               std::vector<std::string>& warnings) {
  SurfaceVolumes volumes;
  for_each_method(progress, warnings,
                  [&](const ContourSurfaceOptions& options, const Method& method, const Progress& p) {
                    ContourSurface surface(locator, options);
                    surface.update(structure, p);
                    volumes.*method.volume_ml = surface.volume_ml();
                    return surface.warnings();
                  });
  return volumes;
}

DividedSurfaceVolumes surface_volumes(const Structure& structure, std::span<const FrameLocator> locators,
                                      const Division& division, const Progress& progress,
                                      std::vector<std::string>& warnings) {
  DividedSurfaceVolumes volumes;
  for_each_method(
      progress, warnings, [&](const ContourSurfaceOptions& options, const Method& method, const Progress& p) {
        const PartitionedSurface surface = partition_surface(structure, locators, division, options, Caps::kClosed, p);
        volumes.total.*method.volume_ml = surface.volume_ml;
        add_parts(surface, method, volumes);
        return surface.warnings;
      });
  return volumes;
}

}  // namespace fathom
