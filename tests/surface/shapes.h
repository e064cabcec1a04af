#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/random.h"
#include "surface/mesh.h"

// Meshes of known shape, closed and turned outward unless said otherwise, without normals.
namespace fathom::shapes {

inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

/// From `low` to `high`, two triangles on each face.
inline Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  }
  const std::vector<std::array<std::int32_t, 4>> faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& [a, b, c, d] : faces) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// A sphere about the origin: 20 * 4^divisions triangles.
inline Mesh icosphere(double radius, int divisions) {
  Mesh mesh;
  const double g = std::numbers::phi;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= radius / vertex.norm();
  for (int round = 0; round < divisions; ++round) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices.size()));
      if (is_new) {
        const Eigen::Vector3d sum =
            mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)];
        mesh.vertices.push_back(radius / sum.norm() * sum);
      }
      return found->second;
    };
    std::vector<Mesh::Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b);
      const std::int32_t bc = middle(b, c);
      const std::int32_t ca = middle(c, a);
      triangles.insert(triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = triangles;
  }
  return mesh;
}

/// About the z axis: `around` by `across` vertices, twice as many triangles.
inline Mesh torus(double radius, double tube_radius, int around, int across) {
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around;
      const double v = 2.0 * std::numbers::pi * j / across;
      const double r = radius + tube_radius * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube_radius * std::sin(v));
      const int k = (i + 1) % around;
      const int l = (j + 1) % across;
      mesh.triangles.push_back({i * across + j, k * across + j, k * across + l});
      mesh.triangles.push_back({i * across + j, k * across + l, i * across + l});
    }
  }
  return mesh;
}

/// A band of `count` squares with half a twist, which has one side only; open.
inline Mesh moebius_strip(int count) {
  Mesh mesh;
  for (std::int32_t i = 0; i < count; ++i) {
    const double u = 2.0 * std::numbers::pi * i / count;
    const Eigen::Vector3d outward(std::cos(u), std::sin(u), 0.0);
    const Eigen::Vector3d across = std::cos(0.5 * u) * outward + std::sin(0.5 * u) * Eigen::Vector3d::UnitZ();
    mesh.vertices.push_back(3.0 * outward - across);
    mesh.vertices.push_back(3.0 * outward + across);
    const bool last = i + 1 == count;
    const std::int32_t low = last ? 1 : 2 * i + 2;
    const std::int32_t high = last ? 0 : 2 * i + 3;
    mesh.triangles.push_back({2 * i, low, high});
    mesh.triangles.push_back({2 * i, high, 2 * i + 1});
  }
  return mesh;
}

/// Both, as two parts.
inline Mesh joined(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::int32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

inline Mesh moved(Mesh mesh, const Eigen::Isometry3d& motion) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = motion * vertex;
  for (Eigen::Vector3d& normal : mesh.normals) normal = motion.linear() * normal;
  return mesh;
}

inline Mesh shifted(Mesh mesh, const Eigen::Vector3d& by) {
  return moved(std::move(mesh), Eigen::Isometry3d(Eigen::Translation3d(by)));
}

/// The other way round.
inline Mesh turned_inside_out(Mesh mesh) {
  for (Mesh::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// A random rotation, and a translation by `distance_mm`.
inline Eigen::Isometry3d random_motion(Random& random, double distance_mm) {
  Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  const Eigen::Vector3d way(random.normal(), random.normal(), random.normal());
  return Eigen::Translation3d(distance_mm * way.normalized()) * turn.normalized();
}

/// The part of a convex mesh where `normal` . x >= `offset`, open where it was cut. No vertex may lie on the plane.
inline Mesh cut(const Mesh& mesh, const Eigen::Vector3d& normal, double offset) {
  Mesh part;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> names;
  const auto height = [&](std::int32_t v) { return normal.dot(mesh.vertices[static_cast<std::size_t>(v)]) - offset; };
  const auto vertex = [&](std::int32_t a, std::int32_t b) {  // a itself, or where the plane cuts its edge to b
    const auto [found, is_new] = names.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(part.vertices.size()));
    if (is_new) {
      const auto [low, high] = std::minmax(a, b);
      const double share = a == b ? 0.0 : height(low) / (height(low) - height(high));
      part.vertices.push_back(
          mesh.vertices[static_cast<std::size_t>(low)] +
          share * (mesh.vertices[static_cast<std::size_t>(high)] - mesh.vertices[static_cast<std::size_t>(low)]));
    }
    return found->second;
  };
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    std::vector<std::int32_t> polygon;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      if (height(a) >= 0.0) polygon.push_back(vertex(a, a));
      if ((height(a) >= 0.0) != (height(b) >= 0.0)) polygon.push_back(vertex(a, b));
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) part.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }
  return part;
}

}  // namespace fathom::shapes
