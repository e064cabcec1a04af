#include "surface/fill_rings.h"

#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

using Vertices = std::vector<Eigen::Vector3d>;

Ring add_ring(const Vertices& points, Vertices& vertices) {
  Ring ring;
  for (const Eigen::Vector3d& point : points) {
    ring.push_back(static_cast<std::int32_t>(vertices.size()));
    vertices.push_back(point);
  }
  return ring;
}

// Wavy circles: never touch while the waves are smaller than the gaps.
Vertices wavy(Random& random, double radius, double x, int points, bool forward) {
  Vertices ring;
  const double phase = random.uniform(0.0, 6.0);
  for (int i = 0; i < points; ++i) {
    const double angle = (forward ? 2.0 : -2.0) * std::numbers::pi * i / points;
    const double r = radius * (1.0 + 0.2 * std::sin(5.0 * angle + phase));
    ring.emplace_back(x + r * std::cos(angle), r * std::sin(angle), 0.0);
  }
  return ring;
}

struct Filled {
  double area = 0.0;      // of all triangles
  double enclosed = 0.0;  // along the normal
  int odd_edges = 0;      // not passed once either way, rings counted as passed backward
};

Filled measured(const std::vector<Mesh::Triangle>& triangles, const std::vector<Ring>& rings, const Vertices& vertices,
                const Eigen::Vector3d& normal) {
  Filled filled;
  std::map<std::pair<std::int32_t, std::int32_t>, int> steps;
  for (const auto& [a, b, c] : triangles) {
    const auto at = [&](std::int32_t v) { return vertices[static_cast<std::size_t>(v)]; };
    const Eigen::Vector3d area = 0.5 * (at(b) - at(a)).cross(at(c) - at(a));
    filled.area += area.norm();
    filled.enclosed += area.dot(normal);
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++steps[{from, to}];
  }
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) ++steps[{ring[(i + 1) % ring.size()], ring[i]}];
  }
  for (const auto& [step, count] : steps) {
    const auto back = steps.find({step.second, step.first});
    if (count != 1 || back == steps.end() || back->second != 1) ++filled.odd_edges;
  }
  return filled;
}

double area_of(const Vertices& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector3d& a = ring[i];
    const Eigen::Vector3d& b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

TEST(FillRings, RingsWithHolesAndIslandsInHolesAreFilledWithoutOverlap) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const Vertices outer = wavy(random, 100.0, 0.0, 200, true);
    const Vertices hole = wavy(random, 30.0, -35.0, 60, false);
    const Vertices other = wavy(random, 25.0, 36.0, 7, false);
    const Vertices island = wavy(random, 15.0, -35.0, 30, true);
    const Vertices apart = wavy(random, 20.0, 180.0, 3, true);
    const double turn = random.uniform(0.0, 6.0);
    Vertices vertices;
    std::vector<Ring> rings;
    double expected = 0.0;
    const Eigen::Isometry3d motion =
        Eigen::Translation3d(Eigen::Vector3d(50.0, -900.0, 30.0)) *
        Eigen::AngleAxisd(turn, Eigen::Vector3d(random.normal(), random.normal(), 0.3).normalized());
    for (const Vertices* ring : {&hole, &apart, &outer, &island, &other}) {
      expected += area_of(*ring);
      Vertices there;
      for (const Eigen::Vector3d& point : *ring) there.push_back(motion * point);
      rings.push_back(add_ring(there, vertices));
    }
    const std::size_t count = vertices.size();
    const Eigen::Vector3d normal = motion.linear().col(2);
    const auto triangles = fill_rings(rings, normal, vertices);
    ASSERT_EQ(vertices.size(), count) << "no fans are needed";
    const Filled filled = measured(triangles, rings, vertices, normal);
    EXPECT_EQ(filled.odd_edges, 0);
    EXPECT_NEAR(filled.enclosed, expected, 1e-9 * expected);
    EXPECT_NEAR(filled.area, expected, 1e-9 * expected) << "triangles overlap";
  }
}

TEST(FillRings, RingsThatRunTheOtherWayAreFilledBackward) {
  Random random(2);
  Vertices vertices;
  const Vertices outer = wavy(random, 10.0, 0.0, 40, false);
  const Vertices hole = wavy(random, 4.0, 0.0, 20, true);
  const std::vector<Ring> rings{add_ring(outer, vertices), add_ring(hole, vertices)};
  const auto triangles = fill_rings(rings, Eigen::Vector3d::UnitZ(), vertices);
  const Filled filled = measured(triangles, rings, vertices, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(filled.odd_edges, 0);
  EXPECT_NEAR(filled.enclosed, area_of(outer) + area_of(hole), 1e-9);
  EXPECT_NEAR(filled.area, -filled.enclosed, 1e-9);
}

TEST(FillRings, CornersOnALineAndDoublePointsStillGiveEveryEdgeOnce) {
  // A square with 20 corners on a side, some of them twice at one place.
  Vertices square;
  for (int side = 0; side < 4; ++side) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.5 * std::numbers::pi * side + 0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (int i = 0; i < 20; ++i) square.push_back(turn * Eigen::Vector3d(-1.0 + 0.1 * (i - i % 2), -1.0, 0.0));
  }
  Vertices vertices;
  const std::vector<Ring> rings{add_ring(square, vertices)};
  const auto triangles = fill_rings(rings, Eigen::Vector3d::UnitZ(), vertices);
  const Filled filled = measured(triangles, rings, vertices, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(filled.odd_edges, 0);
  EXPECT_NEAR(filled.enclosed, 4.0, 1e-12);
  EXPECT_NEAR(filled.area, 4.0, 1e-12);
}

TEST(FillRings, RandomTanglesKeepEveryEdgeAndTheirVectorArea) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    Vertices vertices;
    std::vector<Ring> rings;
    double expected = 0.0;
    const int count = 1 + static_cast<int>(4.0 * random.uniform());
    for (int r = 0; r < count; ++r) {
      Vertices ring;
      const int size = 3 + static_cast<int>(12.0 * random.uniform());
      for (int i = 0; i < size; ++i) {
        // Whole numbers: many corners lie on lines or in one place.
        ring.emplace_back(std::floor(random.uniform(0.0, 6.0)), std::floor(random.uniform(0.0, 6.0)), 0.0);
      }
      expected += area_of(ring);
      rings.push_back(add_ring(ring, vertices));
    }
    const auto triangles = fill_rings(rings, Eigen::Vector3d::UnitZ(), vertices);
    const Filled filled = measured(triangles, rings, vertices, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(filled.odd_edges, 0) << "round " << round;
    EXPECT_NEAR(filled.enclosed, expected, 1e-9) << "round " << round;
  }
}

}  // namespace
}  // namespace fathom
