#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// y = at + slope * x, in pixels.
struct WallSlope {
  double at = 0.0;
  double slope = 0.0;
  double y(double x) const { return at + slope * x; }
};

/// Where part of a wall's echo lies, in pixels below some line.
struct WallProfile {
  double ridge = 0.0;   ///< where it is brightest
  double edge = 0.0;    ///< where it has risen to half above its surroundings
  bool peaked = false;  ///< it has a ridge; else it is a band of even brightness, whose edge alone has a place
};

/// The first echo in brightness from top to bottom that is as bright as `first_echo` of the brightest. Of an echo with
/// a ridge that place counts which neither compression nor a thicker beam moves. Empty where the profile does not rise
/// above its surroundings and fall again.
std::optional<WallProfile> locate_wall(const std::vector<double>& brightness, double first_echo);

/// One stretch of a wall.
struct WallPart {
  double x = 0.0;     ///< its columns' mean
  WallProfile place;  ///< rows
};

/// Means of the columns of `grey` (CV_32FC1) along `line`, in stretches of neighbouring `columns` (rising), from
/// `reach` rows above the line to as many below, and where the wall lies in each.
std::vector<WallPart> wall_parts(const cv::Mat& grey, const WallSlope& line, const std::vector<int>& columns, int reach,
                                 double first_echo);

}  // namespace fathom
