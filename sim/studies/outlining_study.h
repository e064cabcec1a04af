#pragma once

#include <string>
#include <vector>

#include "segmentation/contours.h"
#include "segmentation/live_wire.h"
#include "sim/simulate.h"

namespace fathom {

/// How many clicks an outline took, and how good it is.
struct OutliningTrial {
  int frame = 0;
  int clicks = 0;              ///< seeds placed, and one to close
  double dice = 0.0;           ///< of the live-wire's outline and the truth
  double dice_straight = 0.0;  ///< of the polygon through the same seeds
  Polygon outline_px;          ///< the live-wire's
};

/// A scripted user of the live-wire, who knows the true outline and wants an outline of `wanted_dice`: from its topmost
/// point on, he moves the pointer along it and watches the wire. He clicks at the last place up to which the area
/// between wire and outline is, for its length, small enough: were it as large all round, Dice would be what is wanted.
/// With S the area between, A the area and L the length of the outline, 1 - Dice = S / (2 A), so that a piece of length
/// l may have S <= 2 A (1 - Dice) l / L. Where a wire goes astray he moves on some 20 pixels to see whether it comes
/// back. He closes where that holds as far as the first seed. All places are on the true outline.
OutliningTrial scripted_outline(const cv::Mat& image, const Polygon& truth, double wanted_dice,
                                const LiveWireOptions& options = {});

/// The same on frames of a simulated scan whose section is one outline within the image of at least
/// `least_area_px` square pixels: every `every`th frame of those.
std::vector<OutliningTrial> live_wire_study(const SimulateOptions& scan, int every, double least_area_px,
                                            double wanted_dice, const LiveWireOptions& options = {});

}  // namespace fathom
