#pragma once

#include <span>
#include <vector>

#include "segmentation/contours.h"
#include "segmentation/edge_map.h"
#include "segmentation/edge_preference.h"

namespace fathom {

/// How far a drawn contour is moved to the boundary beside it.
struct RefineOptions {
  EdgeMapOptions edges;
  double reach_px = 8.0;  ///< no point moves farther
  /// How much the line resists to bend away from what was drawn; 0: follows every edge. Counts for the cube of the
  /// edges' scale: coarse speckle shows false edges, which only a stiff line passes by.
  double stiffness = 1.0;
  bool keep_place =
      false;  ///< stay as far beside the steepest place as the drawn contours are on average; else go there
  /// Throws Error as EdgeMapOptions::check, or when a value is out of range.
  void check() const;
};

/// The outlines of one structure on one frame, turned so that the structure is on the right of whoever walks along
/// them: holes run against the others. Points that repeat are dropped.
std::vector<Polygon> structure_on_right(std::span<const Polygon> outlines);

/// What the boundary looks like where the outlines of one structure on one frame were drawn: on its bright side 1 is
/// the inside, -1 the outside.
EdgePreference learn_boundary(const EdgeMap& map, std::span<const Polygon> outlines, const RefineOptions& options);

/// The outlines of one structure on one frame, moved to the nearest boundary that looks as `boundary`: an active
/// contour whose best place within reach is found at once (dynamic programming over shifts across the line), so that it
/// is not caught by speckle. It stays where no boundary is in reach, and where the image is the same all over.
///
/// `beside` are outlines of other structures on the frame: none is moved beyond the middle between the two, and where
/// they touch or cross, lines stay as they are.
///
/// Points come to lie about 2 pixels apart. Outlines neither cross themselves nor each other afterwards, if they did
/// not before. Throws Error as RefineOptions::check.
std::vector<Polygon> refine_outlines(const EdgeMap& map, std::span<const Polygon> outlines,
                                     const EdgePreference& boundary, const RefineOptions& options = {},
                                     std::span<const Polygon> beside = {});

}  // namespace fathom
