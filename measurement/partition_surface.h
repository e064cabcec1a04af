#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "measurement/contour_surface.h"
#include "measurement/plane_match.h"
#include "registration/division.h"
#include "registration/frame_locator.h"
#include "surface/mesh_clip.h"

namespace fathom {

/// The surface of a structure in one convex part of space, made of one sweep.
struct PartSurface {
  std::size_t sweep = 0;
  std::size_t region = 0;           ///< as SpacePartition::Cell::region; several parts may share one
  std::vector<std::size_t> planes;  ///< of the partition, that cut this surface
  ClippedMesh surface;              ///< `plane_of` are planes of the partition
  std::optional<double> volume_ml;
  std::string no_volume;  ///< why there is no volume; empty where there is one
};

/// The surface of a structure over several sweeps.
struct PartitionedSurface {
  std::vector<PartSurface> parts;
  std::vector<PlaneMatch> planes;   ///< that cut the surface
  std::optional<double> volume_ml;  ///< sum of the parts; empty where one has none or is missing, or two do not meet
  std::vector<std::string> warnings;

  /// All parts in one mesh; neighbours have vertices of their own.
  Mesh mesh() const;

  /// Of the structure's surface: without the caps, which lie inside of the structure.
  double surface_area_mm2() const;
};

/// The surface of each sweep runs through all its contours, also those beyond a dividing plane, and is then cut by the
/// planes, so that nothing is lost there where the sections go on. Open contours are closed by the straight line
/// between their ends, which lie where another sweep is used (Treece 2000, section 4.2.3). Where a sweep has no
/// outlines it has no part. With Caps::kOpen, a part has a volume where no more than two planes cut it (appendix B.2).
///
/// `locators` are those of the recordings that the sweeps are of. Throws Error when there are several sweeps but no
/// planes, when no sweep has a surface, and as ContourSurface and clip_mesh; Cancelled.
PartitionedSurface partition_surface(const Structure& structure, std::span<const FrameLocator> locators,
                                     const Division& division, const ContourSurfaceOptions& options,
                                     Caps caps = Caps::kClosed, const Progress& progress = {});

}  // namespace fathom
