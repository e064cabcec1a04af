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

/// A scripted user of the live-wire, who knows the true outline: from its topmost point on, he moves the pointer along
/// it and watches the wire. He clicks at the last place where the wire still kept to the outline (within
/// `tolerance` times the root of its area: eyes judge by the size of what they see), and closes where it does so as far
/// as the first seed. All places are on the true outline.
OutliningTrial scripted_outline(const cv::Mat& image, const Polygon& truth, double tolerance,
                                const LiveWireOptions& options = {});

/// The same on frames of a simulated scan whose section is one outline within the image of at least
/// `least_area_px` square pixels: every `every`th frame of those.
std::vector<OutliningTrial> live_wire_study(const SimulateOptions& scan, int every, double least_area_px,
                                            double tolerance, const LiveWireOptions& options = {});

}  // namespace fathom
