#pragma once

#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include "registration/frame_locator.h"
#include "registration/sweep.h"

namespace fathom {

/// A frame whose place is known.
struct PlacedFrame {
  int frame = 0;                                                       ///< as stored
  Eigen::Affine3d reference_from_image = Eigen::Affine3d::Identity();  ///< pixels (z = 0) to mm
};

/// The frames of `sweep` whose image and pose are valid, in order. Throws Error where the sweep is not in the
/// recording.
std::vector<PlacedFrame> placed_frames(const Recording& recording, const FrameLocator& locator, const Sweep& sweep);
/// The same of all frames.
std::vector<PlacedFrame> placed_frames(const Recording& recording, const FrameLocator& locator);

/// Throws Error unless the recording has grey images of integers of 8 or 16 bits.
void require_grey_integers(const Recording& recording);

/// Unit normal of the image's plane, along image x cross image y.
Eigen::Vector3d frame_normal(const Eigen::Affine3d& reference_from_image);

/// Mean of a pixel's sides, mm.
double pixel_size_mm(const Eigen::Affine3d& reference_from_image);

/// Smallest box around the pixels' centres from `first` to `last` (both inclusive) on all frames, mm.
Eigen::AlignedBox3d box_around(const std::vector<PlacedFrame>& frames, cv::Point first, cv::Point last);

}  // namespace fathom
