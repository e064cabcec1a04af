#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/recording.h"
#include "segmentation/contours.h"

namespace fathom {

/// Points that somebody chose on one frame: along the outline for a live-wire, inside of the structure for a region.
struct FrameSeeds {
  int frame = 0;
  int recording = 0;  ///< index in the exam
  std::vector<Eigen::Vector2d> points_px;
};

/// Reads a file of seeds (docs/file-formats.md). Throws Error when it is damaged: wrong types, points that are not
/// finite or farther than 1e6 pixels away, none or more than 1e4 points, negative frames.
std::vector<FrameSeeds> read_seeds(const std::filesystem::path& path);

/// Throws Error when seeds stand on a frame that a recording does not have, or whose image is marked as invalid, or
/// outside of the image; `recording` is its index.
void require_seeds_on_images(const std::vector<FrameSeeds>& seeds, const Recording& from, int recording);

}  // namespace fathom
