#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace fathom {

struct FillHolesOptions {
  /// Longest gap that is bridged, in empty voxels along an axis (diagonals count by their length); 1 to 15.
  int max_gap_voxels = 9;

  /// Throws Error when the gap is out of range.
  void check() const;
};

/// Gives a value to empty voxels that lie between two filled ones: along the shortest of the lines through the voxel in
/// 13 directions (3 along axes, 6 across faces' diagonals, 4 across space's) whose both ends have a value, by linear
/// interpolation between these ends; the mean of several lines equally short. Ends are voxels that had a value before.
///
/// `voxels` is of three dimensions and type CV_8U, CV_8S, CV_16U or CV_16S; `filled` CV_8U of the same size, 0 where
/// there is no value; both are brought up to date. Returns how many voxels got a value. Throws Error as check().
std::int64_t fill_holes(cv::Mat& voxels, cv::Mat& filled, const FillHolesOptions& options = {});

}  // namespace fathom
