#pragma once

#include <opencv2/core/mat.hpp>

#include "sim/simulate.h"

namespace fathom {

/// How a scan lies about its object: the B-scans as rectangles about all outlines, the outlines, and the surface by
/// discs through them. 8-bit BGR on white. A scan of which no surface can be made shows rectangles and outlines only.
/// Throws Error as simulate.
cv::Mat scan_picture(const SimulateOptions& options);
cv::Mat scan_picture(const SimulatedScan& scan);
/// The frames of `outlines` only, where they are fewer than the scan's.
cv::Mat scan_picture(const SimulatedScan& scan, const Structure& outlines);

}  // namespace fathom
