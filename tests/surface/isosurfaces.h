#pragma once

#include <array>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "surface/isosurface.h"
#include "surface/mesh_check.h"

// Fields whose surfaces are known, and what is expected of all meshes.
namespace fathom::isosurfaces {

inline constexpr double kPi = std::numbers::pi;
inline constexpr std::array kMeshers = {Mesher::kRegularised, Mesher::kTetrahedra, Mesher::kCubes};

inline double ball_mm3(double radius_mm) { return 4.0 / 3.0 * kPi * radius_mm * radius_mm * radius_mm; }

inline PointField ball(const Eigen::Vector3d& centre_mm, double radius_mm) {
  return [=](const Eigen::Vector3d& place_mm) { return radius_mm - (place_mm - centre_mm).norm(); };
}

inline Eigen::AlignedBox3d cube(double half_mm) {
  return {Eigen::Vector3d::Constant(-half_mm), Eigen::Vector3d::Constant(half_mm)};
}

inline IsosurfaceOptions options_for(Mesher mesher, std::optional<double> spacing_mm = std::nullopt) {
  IsosurfaceOptions options;
  options.mesher.mesher = mesher;
  options.spacing_mm = spacing_mm;
  return options;
}

inline void expect_sound(const Mesh& mesh) {
  require_valid(mesh, "mesh");
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.unused_vertices, 0);
}

}  // namespace fathom::isosurfaces
