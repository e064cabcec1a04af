#include "surface/cap_overlap.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/surface/shapes.h"

namespace fathom {
namespace {

TEST(CapOverlap, IsWhatTheSectionsOfTwoBallsHaveInCommon) {
  const Mesh ball = shapes::icosphere(10.0, 5);
  Random random(2);
  for (const double aside : {0.0, 1.0, 9.0, 21.0}) {
    const Eigen::Vector3d normal = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Hyperplane<double, 3> plane(normal, -2.0);
    const double r = std::sqrt(96.0);
    const ClippedMesh above = split_mesh(ball, plane).positive;
    const ClippedMesh below = split_mesh(shapes::shifted(ball, aside * normal.unitOrthogonal()), plane).negative;
    const double common = aside < 2.0 * r ? 2.0 * r * r * std::acos(aside / (2.0 * r)) -
                                                0.5 * aside * std::sqrt(4.0 * r * r - aside * aside)
                                          : 0.0;
    EXPECT_NEAR(cap_overlap_mm2(above, 0, below, 0, normal), common, 0.6) << aside;
    if (aside > 0.0) continue;
    EXPECT_NEAR(cap_overlap_mm2(above, 0, below, 0, normal), cap_area_mm2(above, 0), 1e-9);
  }
}

}  // namespace
}  // namespace fathom
