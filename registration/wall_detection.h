#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/bright_spots.h"

namespace fathom {

/// A flat wall's echo in one frame: the ridge of an echo that has one, which neither compression nor the beam's
/// thickness moves; of an even, bright band (a gain so high that the echo is white, or a thick layer) its upper edge,
/// where it has risen to half.
struct WallLine {
  int frame = 0;                                         ///< as stored
  Eigen::Vector2d point_px = Eigen::Vector2d::Zero();    ///< in the middle of the part that was seen
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< unit, to the right
  double sigma_px = 0.0;                                 ///< spread of the wall's parts about the line
  double reach_px = 0.0;  ///< along the line, standard deviation of the columns' places about `point_px`
};

struct WallDetectionOptions {
  double min_contrast = 0.15;  ///< of the largest value of the pixel type
  double min_columns = 0.2;    ///< share of the columns in which the line must be seen
  double max_tilt_rad = 0.87;  ///< from horizontal, 50 degrees
  double first_echo = 0.6;     ///< of a column's brightest echo: the first that is as bright is the wall's, not a
                               ///< reverberation below it
  double tolerance = 0.005;    ///< of the image's height: distance of a column's echo from a line it belongs to
  int trials = 200;            ///< lines tried
  std::uint64_t seed = 1;
  void check() const;  ///< Throws Error when a value is out of range.
};

/// The brightest straight line from left to right in an image, to a fraction of a pixel; empty where there is none.
/// `frame` is 0. The same seed gives the same line.
std::optional<WallLine> detect_wall_in_image(const cv::Mat& image, const WallDetectionOptions& options = {});

/// The wall in every frame that shows it and whose image is valid: its ridge or its upper edge, as most frames have it,
/// in all. Throws Error when the recording has no images or no
/// frame shows a wall; Cancelled.
std::vector<WallLine> detect_wall(const Recording& recording, const WallDetectionOptions& options = {},
                                  const Progress& progress = {});

/// The image of a single small target: a bead, or crossed wires.
struct SpotPoint {
  int frame = 0;  ///< as stored
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
};

/// The spot of greatest contrast in every frame that has one, unless another is more than `rival` times as bright: then
/// the frame does not tell. Throws Error when the recording has no images or no frame shows a spot; Cancelled.
std::vector<SpotPoint> detect_point(const Recording& recording, const BrightSpotOptions& options = {},
                                    double rival = 0.8, const Progress& progress = {});

}  // namespace fathom
