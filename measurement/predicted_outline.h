#pragma once

#include <opencv2/core/mat.hpp>

#include "measurement/carried_planes.h"
#include "measurement/curved_gap.h"
#include "measurement/section_gap.h"
#include "measurement/tapered_end.h"
#include "segmentation/pixel_grid.h"

namespace fathom {

/// What two drawn sections say of a frame between them, without its pixels; matrices CV_32FC1, signed distances in
/// blocks of the grid, positive inside.
struct PredictedOutline {
  cv::Mat distance;    ///< by interpolation that maximal discs guide, of second order; towards an end as TaperedEnd
  cv::Mat change;      ///< how far the distance straight across changes from the one section to the other, without sign
  cv::Mat depth;       ///< straight across, the larger of the distances of both sections
  cv::Mat doubt;       ///< TaperedEnd::Value::doubt_mm; empty where the structure does not end
  double share = 0.5;  ///< of the way from the first section to the second, on average
};

/// What leads through a gap: one of these, the others are null.
struct OutlineWays {
  const CurvedGap* across = nullptr;        ///< that of the gap
  const TaperedEnd* first_ends = nullptr;   ///< how the first section ends before the second
  const TaperedEnd* second_ends = nullptr;  ///< how the second section begins after the first
};

/// `place` is the frame's plane, in the same (a, b) as the gap's, and need not lie exactly between the sections.
PredictedOutline predict_outline(const SectionGap& gap, const OutlineWays& ways, const CarriedPlane& place,
                                 const PixelGrid& grid);

/// The distances of one section on its own frame. Where it is absent all lies `absent_blocks` outside.
cv::Mat section_distances(const SectionShape& shape, const CarriedPlane& place, const PixelGrid& grid,
                          double absent_blocks);

/// Side of a block in millimetres.
double block_mm(const CarriedPlane& place, const PixelGrid& grid);

}  // namespace fathom
