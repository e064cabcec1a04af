#include "surface/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace shapes;
using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

Mesh triangles(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Mesh::Triangle>& triangles) {
  Mesh mesh;
  mesh.vertices = vertices;
  mesh.triangles = triangles;
  return mesh;
}

// However the mesh is turned and however its triangles are written, the answer is the same.
void expect_crossing(const Mesh& mesh, bool crossing) {
  const Pairs expected = crossing ? Pairs{{0, 1}} : Pairs{};
  for (int turn = 0; turn < 9; ++turn) {
    Mesh turned = mesh;
    std::rotate(turned.triangles[0].begin(), turned.triangles[0].begin() + turn % 3, turned.triangles[0].end());
    std::rotate(turned.triangles[1].begin(), turned.triangles[1].begin() + turn / 3, turned.triangles[1].end());
    EXPECT_EQ(self_intersections(turned), expected) << turn;
    std::swap(turned.triangles[0], turned.triangles[1]);
    EXPECT_EQ(self_intersections(turned), expected) << turn;
    for (Eigen::Vector3d& vertex : turned.vertices) vertex = Eigen::Vector3d(vertex.y(), vertex.z(), vertex.x());
    EXPECT_EQ(self_intersections(turned), expected) << turn;
    EXPECT_EQ(self_intersections(turned_inside_out(turned)), expected) << turn;
  }
}

TEST(SelfIntersections, ThereAreNoneInASolid) {
  EXPECT_TRUE(self_intersections({}).empty());
  EXPECT_TRUE(self_intersections(tetrahedron()).empty());
  EXPECT_TRUE(self_intersections(icosphere(10.0, 4)).empty());
  EXPECT_TRUE(self_intersections(torus(10.0, 3.0, 60, 30)).empty());
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    // Flat faces that rounding leaves not quite flat, far out.
    EXPECT_TRUE(self_intersections(moved(box({0, 0, 0}, {10, 20, 30}), random_motion(random, 1e4))).empty());
  }
}

TEST(SelfIntersections, OfTwoSpheresLieOnTheCircleWhereTheyCross) {
  const Mesh mesh = joined(icosphere(10.0, 3), shifted(icosphere(10.0, 3), {12.0, 0.3, 0.1}));
  const Pairs pairs = self_intersections(mesh);
  const std::int32_t half = 1280;
  // The circle of radius 8 is 50 mm long and triangles' sides are about 1.5 mm.
  EXPECT_GT(pairs.size(), 50u);
  EXPECT_LT(pairs.size(), 400u);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  EXPECT_TRUE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
  for (const auto& [t, u] : pairs) {
    EXPECT_LT(t, half);
    EXPECT_GE(u, half);
    for (const std::int32_t vertex : mesh.triangles[static_cast<std::size_t>(t)]) {
      const Eigen::Vector3d& at = mesh.vertices[static_cast<std::size_t>(vertex)];
      EXPECT_NEAR(at.x(), 6.0, 2.5);
      EXPECT_NEAR(std::hypot(at.y(), at.z()), 8.0, 2.5);
    }
  }
  EXPECT_EQ(self_intersections(mesh, 7).size(), 7u);
  EXPECT_EQ(self_intersections(mesh, 0).size(), 0u);
}

TEST(SelfIntersections, OneSphereInAnotherCrossesNothing) {
  EXPECT_TRUE(self_intersections(joined(icosphere(10.0, 3), shifted(icosphere(8.0, 3), {1.0, 0.0, 0.0}))).empty());
}

TEST(SelfIntersections, AreTheSameWhicheverWayTheyAreLookedFor) {
  // Large and small triangles at random, against all pairs one by one.
  Random random(5);
  Mesh mesh;
  for (std::int32_t t = 0; t < 120; ++t) {
    const double size = std::pow(10.0, random.uniform(-1.0, 1.0));
    const Eigen::Vector3d centre(random.uniform(0, 10), random.uniform(0, 10), random.uniform(0, 10));
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(centre + size * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  Pairs expected;
  for (std::int32_t t = 0; t < 120; ++t) {
    for (std::int32_t u = t + 1; u < 120; ++u) {
      Mesh two = mesh;
      two.triangles = {mesh.triangles[static_cast<std::size_t>(t)], mesh.triangles[static_cast<std::size_t>(u)]};
      if (!self_intersections(two).empty()) expected.emplace_back(t, u);
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(self_intersections(mesh), expected);
}

TEST(SelfIntersections, OfTrianglesWithoutACommonVertex) {
  const std::vector<Mesh::Triangle> apart = {{0, 1, 2}, {3, 4, 5}};
  const auto with = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b, c}, apart);
  };
  expect_crossing(with({1, 1, -1}, {1, 1, 1}, {9, 9, 0}), true);       // a side goes through
  expect_crossing(with({-5, 1, -5}, {-5, 1, 5}, {9, 1, 0}), true);     // it is cut across
  expect_crossing(with({1, 1, 0}, {1, 2, 3}, {2, 1, 3}), true);        // a corner touches it
  expect_crossing(with({1, 1, 1e-300}, {1, 2, 3}, {2, 1, 3}), false);  // or nearly
  expect_crossing(with({2, 2, -1}, {2, 2, 1}, {9, 9, 0}), true);       // side on side, at a point
  expect_crossing(with({2.0000001, 2, -1}, {2.0000001, 2, 1}, {9, 9, 0}), false);
  expect_crossing(with({1, 1, 0}, {2, 1, 0}, {1, 2, 0}), true);        // inside it, in its plane
  expect_crossing(with({-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}), true);  // around it, in its plane
  expect_crossing(with({5, 0, 0}, {9, 0, 0}, {5, 4, 0}), false);       // beside it, in its plane
  expect_crossing(with({4, 0, 0}, {9, 0, 0}, {9, 4, 0}), true);        // corner on corner
  expect_crossing(with({1, 1, 1}, {3, 1, 1}, {1, 3, 1}), false);       // above it
  expect_crossing(with({3, 3, -1}, {3, 3, 1}, {4, 3, 0}), false);      // through its plane, beside it
}

TEST(SelfIntersections, OfTrianglesWithACommonVertexReachAwayFromIt) {
  const std::vector<Mesh::Triangle> fan = {{0, 1, 2}, {0, 3, 4}};
  const auto with = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b}, fan);
  };
  expect_crossing(with({1, 1, -1}, {1, 1, 1}), true);
  expect_crossing(with({9, 9, -1}, {9, 9, 1}), true);
  expect_crossing(with({-1, 1, -1}, {-1, 1, 1}), false);
  expect_crossing(with({-4, 0, 0}, {0, -4, 0}), false);  // in its plane
  expect_crossing(with({1, 2, 0}, {-4, 0, 0}), true);    // in its plane, overlapping
  expect_crossing(with({2, 0, 0}, {2, -4, 0}), true);    // in its plane, along a part of a side
  expect_crossing(with({2, 0, 0}, {2, -4, 1}), true);    // from there down
  expect_crossing(with({2, -1e-9, 0}, {2, -4, 1}), false);
}

TEST(SelfIntersections, OfTrianglesWithACommonSideAreFoldsAndDoubles) {
  const std::vector<Mesh::Triangle> hinge = {{0, 1, 2}, {1, 0, 3}};
  const auto with = [&](const Eigen::Vector3d& a) { return triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a}, hinge); };
  expect_crossing(with({0, -4, 0}), false);
  expect_crossing(with({1, 3, 0}), true);
  expect_crossing(with({1, 3, 1e-9}), false);
  expect_crossing(triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {1, 0, 2}}), true);
}

TEST(SelfIntersections, PassOverTrianglesWithoutArea) {
  EXPECT_TRUE(self_intersections(triangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 0}, {1, 1, 1}},
                                           {{0, 1, 2}, {3, 4, 5}}))
                  .empty());
}

TEST(SelfIntersections, AreDecidedExactlyWhereRoundingIsInDoubt) {
  // A point of the plane x + y + z = 3 whose coordinates are exact, and its neighbours in the last bit.
  const double a = 1.0 + 0x1p-30;
  const double b = 1.0 - 0x1p-31;
  const auto with = [&](double z) {
    return triangles({{9, -3, -3}, {-3, 9, -3}, {-3, -3, 9}, {a, b, z}, {a + 5, b + 5, z + 5}, {a + 5, b + 4, z + 5}},
                     {{0, 1, 2}, {3, 4, 5}});
  };
  EXPECT_EQ(self_intersections(with(3.0 - a - b)).size(), 1u);
  EXPECT_EQ(self_intersections(with(std::nextafter(3.0 - a - b, 9.0))).size(), 0u);
  EXPECT_EQ(self_intersections(with(std::nextafter(3.0 - a - b, -9.0))).size(), 1u);
}

}  // namespace
}  // namespace fathom
