#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "registration/calibration_scan.h"

namespace fathom {

/// Where a calibration's errors lie: on the left in the image (every thing seen, its colour and size by its distance
/// from where it belongs), on the right by part of the phantom (mean and largest) and by frame (mean). `captions` are
/// lines printed below. 8-bit BGR. Throws Error where `residuals` is empty.
cv::Mat calibration_picture(const CalibrationScan& scan, const std::vector<Residual>& residuals,
                            const std::vector<std::string>& captions);

}  // namespace fathom
