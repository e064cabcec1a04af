#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace fathom {

/// One corner of a triangle or end of a line, as the graphics card reads it. Without a normal it is drawn in its colour
/// as it is.
struct SceneVertex {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<unsigned char, 4> rgba{255, 255, 255, 255};
};

/// Three white vertices for each triangle; with normals from the faces around each vertex where the mesh has none.
std::vector<SceneVertex> scene_vertices(const Mesh& mesh);

}  // namespace fathom
