#include "registration/convex_parts.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

Eigen::Vector3d random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

TEST(ConvexParts, EveryPointLiesInOnePartAndThatUsesItsSweep) {
  Random random(5);
  std::size_t fewer = 0;
  for (int round = 0; round < 50; ++round) {
    std::vector<SweepShape> sweeps;
    for (int i = 0; i < 2 + round % 5; ++i) {
      const Eigen::Vector3d centre = random_point(random, 50.0);
      sweeps.push_back({{centre}, {centre}, {centre}});
    }
    std::vector<DividingPlane> planes;
    for (int i = 0; i < 1 + round % 7; ++i) {
      planes.emplace_back(random_point(random, 1.0).normalized(), random_point(random, 30.0));
    }
    const SpacePartition partition(sweeps, planes);
    const std::vector<ConvexPart> parts = convex_parts(partition);
    ASSERT_LE(parts.size(), partition.cells().size());
    fewer += parts.size() < partition.cells().size();
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d point = random_point(random, 60.0);
      int within = 0;
      for (const ConvexPart& part : parts) {
        bool inside = true;
        for (const DividingPlane& plane : part.bounds) inside = inside && plane.signedDistance(point) >= 0.0;
        if (!inside) continue;
        ++within;
        EXPECT_EQ(part.sweep, *partition.sweep_at(point));
        for (const SpacePartition::Cell& cell : partition.cells()) {
          if (cell.sides != partition.sides_at(point)) continue;
          EXPECT_EQ(part.region, cell.region);
        }
      }
      EXPECT_EQ(within, 1) << "round " << round;
    }
  }
  EXPECT_GT(fewer, 20u) << "cells of one sweep are joined";
}

}  // namespace
}  // namespace fathom
