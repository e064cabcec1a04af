#pragma once

#include <vector>

#include <Eigen/Core>

#include "viewer/scene_vertex.h"

namespace fathom {

class Session;

// What the Outline pane draws, from a session with a calibrated document.

/// Corners of the first, last and some further placed frames of all recordings, mm.
std::vector<Eigen::Vector3d> all_corners(const Session& session);
/// Where the B-scans look, on average: a unit vector; zero where no frame has a place.
Eigen::Vector3d mean_image_depth(const Session& session);

/// Frames as goal posts, open at the far side from the probe; not more than some hundred of them. Ends of lines.
std::vector<SceneVertex> post_lines(const Session& session);
/// The shown frame, whole. Empty where its place is unknown.
std::vector<SceneVertex> current_post_lines(const Session& session);
/// All contours in their structures' colours, extremities as crosses.
std::vector<SceneVertex> outline_lines(const Session& session);

/// Dividing planes: corners of triangles.
struct PlaneScene {
  std::vector<SceneVertex> separating;  ///< where a plane separates two sweeps
  std::vector<SceneVertex> whole;       ///< all of its disc, faint
  std::vector<Eigen::Vector3d> centres_mm;
};
PlaneScene plane_scene(const Session& session);

}  // namespace fathom
