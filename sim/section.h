#pragma once

#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"
#include "sim/solid.h"

namespace fathom {

/// The B-scan of a solid: 255 where a pixel's centre is inside it or on its surface, 0 elsewhere. CV_8UC1.
/// `solid_from_image` maps pixels (z = 0) to the solid's coordinates.
cv::Mat section_image(const Solid& solid, const Eigen::Affine3d& solid_from_image, cv::Size size);

/// The true outlines of a plane's section of a solid, in pixels, not bounded by any image. Outer lines and holes do
/// not cross; even-odd filling gives the section.
///
/// Points lie on the surface to 1e-9 mm, corners to 1e-3 pixels; the polygons' area is that of the section to 1e-4.
/// Parts smaller than 1/512 of the solid's diameter may be missed. The image's columns must be perpendicular.
std::vector<Polygon> section_outlines(const Solid& solid, const Eigen::Affine3d& solid_from_image);

/// The same within an image of `size`, bounded by the outer edges of its outer pixels. An outline that the border cuts
/// is open: its ends lie on the border, and the straight line between them runs along it.
std::vector<Contour> image_outlines(const Solid& solid, const Eigen::Affine3d& solid_from_image, cv::Size size);

}  // namespace fathom
