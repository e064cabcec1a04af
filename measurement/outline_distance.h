#pragma once

#include <span>
#include <vector>

#include "measurement/section_raster.h"
#include "segmentation/contours.h"

namespace fathom {

/// For every point of a raster the nearest point of some outlines and its distance, without sign, all in cells.
struct NearestPoints {
  std::vector<float> distance;
  std::vector<float> x;
  std::vector<float> y;
};

/// Exact within a cell of the outlines, which are in cells from the raster's origin; farther away the nearest of the
/// points found there, by vectors passed on from point to point, which is at most a few hundredths of a cell too far.
NearestPoints nearest_outline_points(std::span<const Polygon> outlines, const SectionRaster& raster);

}  // namespace fathom
