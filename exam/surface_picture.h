#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "registration/frame_locator.h"
#include "segmentation/contours.h"
#include "surface/mesh.h"

namespace fathom {

/// One shaded picture of structures' surfaces, `meshes` in the order of `structures`, seen as in report_picture; the
/// outlines that they pass through are drawn where they are not hidden. `captions` are lines printed below. 8-bit BGR.
/// Throws Error when no mesh has a triangle.
cv::Mat surface_picture(const std::vector<Mesh>& meshes, const FrameLocator& locator,
                        const std::vector<Structure>& structures, const std::vector<std::string>& captions);

}  // namespace fathom
