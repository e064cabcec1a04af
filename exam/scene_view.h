#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// How pictures of a structure in space look at it: the rows are right, down and away from the viewer. The long axis of
/// `points` lies across, the probe is on top as in the B-scan, and all is seen obliquely from above. `depth` is where
/// the B-scans look, a unit vector or zero.
Eigen::Matrix3d scene_view(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& depth);

/// The direction in which the outlined B-scans look, on average: a unit vector; zero where there is none.
Eigen::Vector3d mean_depth(const FrameLocator& locator, const std::vector<Structure>& structures);

/// A structure's colour, in the order of OpenCV: blue, green, red.
cv::Scalar color_of(const Structure& structure);

}  // namespace fathom
