#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "measurement/contour_surface.h"
#include "surface/mesh_check.h"
#include "tests/measurement/sphere_scan.h"

// What the tests of surfaces through contours have in common: a ball, and how meshes are judged.
namespace fathom::surfaces {

constexpr double kPi = std::numbers::pi;
inline const Eigen::Vector3d kCentre(12.0, 14.0, 0.0);
constexpr double kRadius = 10.0;

inline std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline void expect_sound(const Mesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
}

inline void expect_same(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_TRUE(a.vertices == b.vertices);
  EXPECT_TRUE(a.triangles == b.triangles);
  EXPECT_TRUE(a.normals == b.normals);
  EXPECT_TRUE(a.sweep_signs == b.sweep_signs);
}

/// Millimetres, never too small; of triangles with their first corner within 3 mm.
inline double distance_to(const Mesh& mesh, const Eigen::Vector3d& point) {
  double least = 1e300;
  for (const Mesh::Triangle& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d u = mesh.vertices[static_cast<std::size_t>(t[1])] - a;
    const Eigen::Vector3d v = mesh.vertices[static_cast<std::size_t>(t[2])] - a;
    const Eigen::Vector3d w = point - a;
    if (w.norm() > 3.0) continue;
    // Clamped barycentric coordinates overestimate the distance a little near corners, which is on the safe side.
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), wu = w.dot(u), wv = w.dot(v);
    const double d = uu * vv - uv * uv;
    double s = std::clamp((wu * vv - wv * uv) / d, 0.0, 1.0);
    double r = std::clamp((wv * uu - wu * uv) / d, 0.0, 1.0 - s);
    least = std::min(least, (w - s * u - r * v).norm());
  }
  return least;
}

/// Cones between the circles: what linear interpolation of distances makes of parallel sections.
inline double stack_of_cones_mm3(const std::vector<double>& places) {
  double sum = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double r1 = std::sqrt(kRadius * kRadius - places[i - 1] * places[i - 1]);
    const double r2 = std::sqrt(kRadius * kRadius - places[i] * places[i]);
    sum += kPi / 3.0 * (places[i] - places[i - 1]) * (r1 * r1 + r1 * r2 + r2 * r2);
  }
  return sum;
}

}  // namespace fathom::surfaces
