#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/scan_path.h"

namespace fathom {

/// One line of the table of multiple sweeps, after Treece 2000, figure 4.10.
struct SweepPattern {
  const char* name;
  /// The images' width and height, as multiples of the object's extent along the axes of the first sweep's images.
  Eigen::Vector2d image;
  std::vector<ScanGeometry> sweeps;
};

/// The patterns of several sweeps.
std::span<const SweepPattern> sweep_table();

/// How a phantom is scanned in a pattern.
struct ScanPlan {
  cv::Size image_size = kImageSize;
  std::vector<ScanPath> sweeps;  ///< one after another
  bool cuts_off = false;         ///< images are smaller than the object, and show what is in them only
};

/// A pattern of one sweep shows the whole object. In one of several, dividing planes are placed between the sweeps, and
/// every sweep begins and ends close to the edge of what of the object is in its part of space (Treece 2000, section
/// 4.3). Throws Error, naming the choice, for an unknown pattern.
ScanPlan make_scan_plan(const Phantom& phantom, const std::string& pattern);
ScanPlan make_scan_plan(const Phantom& phantom, const SweepPattern& pattern);

/// All, those of several sweeps last.
std::vector<std::string> pattern_names();

/// Throws Error when there are fewer frames than sweeps, so that one would have none. The first of them get one frame
/// more where they cannot be shared out evenly.
std::vector<int> frames_of_sweeps(int frames, std::size_t sweeps);

}  // namespace fathom
