#pragma once

#include <memory>
#include <span>
#include <vector>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "measurement/carried_planes.h"
#include "measurement/propagate.h"
#include "measurement/section_shape.h"
#include "segmentation/pixel_grid.h"

namespace fathom {

/// What a person said of one frame: outlines, a point or an absence.
struct DrawnSection {
  int frame = 0;
  CarriedPlane place;
  std::shared_ptr<const SectionShape> shape;
  std::vector<Polygon> outlines_px;
};

/// A frame to be filled.
struct OpenFrame {
  int frame = 0;
  CarriedPlane place;
};

/// One filled frame; fields as in PropagatedFrame.
struct FilledFrame {
  int frame = 0;
  PixelGrid grid;
  cv::Mat distance;  ///< positive inside, on the grid
  double expected_error = 0.0;
  double moved = 0.0;
  double change = 0.0;
};

/// The drawn sections that a gap lies between and those beyond them, as far as propagation leads.
struct DrawnAround {
  const DrawnSection* first = nullptr;
  const DrawnSection* second = nullptr;
  std::vector<const DrawnSection*> before;  ///< from the one next to `first` on, two at most
  std::vector<const DrawnSection*> after;   ///< from the one next to `second` on, two at most
  bool placed = true;                       ///< false: how far the frames are apart is not known
};

/// Fills frames between two drawn ones, at least one of which has an area. Throws Error as Recording::image and
/// grid_around.
std::vector<FilledFrame> fill_run(const Recording& recording, const DrawnAround& drawn,
                                  std::span<const OpenFrame> frames, const PropagateOptions& options);

}  // namespace fathom
