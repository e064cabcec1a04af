#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "registration/frame_locator.h"
#include "segmentation/contours.h"

namespace fathom {

/// The contours of one structure on one frame, in space.
struct CrossSection {
  int frame = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit; image x cross image y, whichever way drawn
  Eigen::Vector3d vector_area_mm2 =
      Eigen::Vector3d::Zero();                            ///< along `normal`, holes subtracted; zero at an extremity
  Eigen::Vector3d centroid_mm = Eigen::Vector3d::Zero();  ///< in reference coordinates, weighted by area
  /// How far the frame has come since the first section: the way of one pixel, the mean of the centroids. Does not
  /// jump with the shape of the organ, as the way of the centroids does. 0 everywhere: not known.
  double along_mm = 0.0;
  Eigen::Vector2d centroid_px = Eigen::Vector2d::Zero();  ///< the same centroid in the frame's pixels
};

/// Sets `along_mm` by `centroid_px`; all poses are known, as of what cross_sections gives.
void measure_way(std::vector<CrossSection>& sections, const FrameLocator& locator);

/// Area in pixels squared, never negative, and centroid in pixels of polygons that combine by even-odd. They have no
/// `outline_fault` (segmentation/outline_topology.h). Without an area the centroid is the mean of the points.
struct PlaneArea {
  double area_px2 = 0.0;
  Eigen::Vector2d centroid_px = Eigen::Vector2d::Zero();
};
PlaneArea even_odd_area(const std::vector<const Polygon*>& polygons);

/// Cross-sections of a structure in the order of its frames, one for each frame with closed contours or an extremity.
/// `warnings`, if any, is added to.
///
/// Frames whose pose is unknown are left out and named in `warnings`, which also says when they were the first or last.
/// Frames marked as absent have no section; those between two sections are named in `warnings`.
/// Throws Error as frame_marks does.
std::vector<CrossSection> cross_sections(const Structure& structure, const FrameLocator& locator,
                                         std::vector<std::string>* warnings);

}  // namespace fathom
