#pragma once

#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/types.hpp>

#include "registration/calibration.h"
#include "registration/fan_mask.h"

namespace fathom {

/// The part of the images that is used, as typed.
struct ImageArea {
  std::vector<int> clip;       ///< x, y, width, height in pixels; empty: the whole image
  std::vector<double> sector;  ///< x, y, radii in pixels, angles in degrees; empty: no fan

  std::optional<cv::Rect> rectangle() const;
  std::optional<Fan> fan(const Calibration& calibration) const;
};

/// Adds `--clip` and `--fan`.
void add_image_area(CLI::App& command, ImageArea& area);

}  // namespace fathom
