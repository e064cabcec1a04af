#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "registration/division.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// Volumes of the surfaces through a structure's contours, by what guides the interpolation; empty where there is none.
struct SurfaceVolumes {
  std::optional<double> shape_based_ml;
  std::optional<double> centroid_guided_ml;
  std::optional<double> disc_guided_ml;         ///< linear between each two outlines, as the two above
  std::optional<double> disc_guided_curved_ml;  ///< of second order: reads the outlines beyond as well
};

/// The same of surfaces that dividing planes cut.
struct DividedSurfaceVolumes {
  SurfaceVolumes total;
  std::map<std::size_t, SurfaceVolumes> by_region;  ///< regions of the partition in which a surface has a part
};

/// What prevents a surface goes to the warnings, each once. Throws Cancelled.
SurfaceVolumes surface_volumes(const Structure& structure, const FrameLocator& locator, const Progress& progress,
                               std::vector<std::string>& warnings);

/// `locators` are those of the recordings that the sweeps are of; the division has planes. Warnings as above.
DividedSurfaceVolumes surface_volumes(const Structure& structure, std::span<const FrameLocator> locators,
                                      const Division& division, const Progress& progress,
                                      std::vector<std::string>& warnings);

}  // namespace fathom
