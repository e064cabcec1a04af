#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "registration/fan_mask.h"

namespace fathom {

/// The part of a scanner's picture that shows the patient.
struct ImageShape {
  cv::Rect box;            ///< the smallest rectangle around it, pixels
  std::optional<Fan> fan;  ///< where it is the sector of a curved or phased probe; empty: the rectangle itself

  bool contains(double x_px, double y_px) const;
};

/// Finds it from a few frames: echoes change from frame to frame, while what the scanner draws around them stands
/// still.
class ImageShapeFinder {
 public:
  /// Frames of one size and type (grey, or RGB), the first decides; others are ignored. Keeps no copy of a frame, only
  /// the least and largest value of every pixel.
  void add(const cv::Mat& frame);
  int frames() const { return frames_; }
  /// The largest value of every pixel; empty without frames.
  const cv::Mat& largest() const { return largest_; }

  /// Empty where fewer than 3 frames came, or too little moved to tell. A fan is given only where it fits: straight
  /// sides that meet, and nearly all that moved lies inside. `pixel_aspect` is a pixel's width by its height.
  std::optional<ImageShape> find(double pixel_aspect = 1.0) const;

 private:
  cv::Mat least_, largest_;
  int frames_ = 0;
};

}  // namespace fathom
