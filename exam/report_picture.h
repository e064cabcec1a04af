#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"
#include "core/atomic_file.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// One picture of what was outlined: on the left the B-scan `frame` with its contours, on the right all contours in
/// space, their frames as goal posts and `frame` highlighted. `captions` are lines printed below. 8-bit BGR.
/// Throws Error when `frame` has no image or no contour of any structure has a known place.
cv::Mat report_picture(const Recording& recording, const FrameLocator& locator,
                       const std::vector<Structure>& structures, int frame, const std::vector<std::string>& captions);

/// Writes a PNG, whole or not at all. Throws Error.
void write_png(const cv::Mat& picture, const std::filesystem::path& path);
/// The same into a file that is committed together with others.
void write_png(const cv::Mat& picture, AtomicFile& file);

}  // namespace fathom
