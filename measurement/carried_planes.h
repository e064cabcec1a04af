#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "measurement/section_plane.h"
#include "registration/frame_locator.h"

namespace fathom {

/// A frame's plane, and where its pixels lie on it.
struct CarriedPlane {
  SectionPlane plane;
  Eigen::Affine2d ab_from_image = Eigen::Affine2d::Identity();  ///< pixels to (a, b) in millimetres
  int run = 0;                                                  ///< planes of the same number share (a, b)
};

/// The plane that lies over `plane` along the average normal: the one through `point` with the unit normal `normal`,
/// with axes such that points with the same (a, b) lie over each other. Treece 2000, figure 3.22. Between planes that
/// face each other nowhere near (normals more than kMaxCarryAngle_rad apart) there is no average normal: empty.
std::optional<SectionPlane> carried_to(const SectionPlane& plane, const Eigen::Vector3d& point,
                                       const Eigen::Vector3d& normal);

/// Beyond it the average normal runs nearly within the planes.
inline constexpr double kMaxCarryAngle_rad = 2.8;

/// The planes of all frames, (a, b) carried from each valid frame to the next; empty where no pose is known.
///
/// (a, b) starts at the first pixel of the first valid frame, a along the image's x axis. Because it is carried through
/// all recorded frames, a frame's (a, b) does not depend on which of the frames are outlined. After a frame that
/// (a, b) cannot be carried to, it starts afresh.
std::vector<std::optional<CarriedPlane>> carried_planes(const FrameLocator& locator);

}  // namespace fathom
