#include "measurement/planar_representation.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/measurement/sections.h"

namespace fathom {
namespace {

using namespace sections;

double angle(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

TEST(PlanarRepresentation, KeepsAreasStepsAndTheAnglesBetweenThem) {
  const Sections sweep = sphere_free(10.0, 0.7, 15);
  const PlanarRepresentation plane = planar_representation(sweep);
  ASSERT_EQ(plane.normals.size(), sweep.size());
  ASSERT_EQ(plane.centres.size(), sweep.size());
  for (std::size_t i = 1; i < sweep.size(); ++i) {
    const Eigen::Vector3d step = sweep[i].centroid_mm - sweep[i - 1].centroid_mm;
    const Eigen::Vector2d drawn = plane.centres[i] - plane.centres[i - 1];
    EXPECT_NEAR(plane.normals[i].norm(), sweep[i].vector_area_mm2.norm(), 1e-9);
    EXPECT_NEAR(drawn.norm(), step.norm(), 1e-12);
    EXPECT_NEAR(plane.normals[i].dot(drawn), sweep[i].vector_area_mm2.dot(step), 1e-9);
    EXPECT_NEAR(plane.normals[i - 1].dot(drawn), sweep[i - 1].vector_area_mm2.dot(step), 1e-9);
  }
}

TEST(PlanarRepresentation, OfASweepInOnePlaneIsThatSweep) {
  // Planes that all contain the x direction, along a path that bends left, then right, faster than the planes turn.
  Sections sweep;
  for (int i = 0; i < 30; ++i) {
    const double u = 0.2 * i;
    const double turn = 0.5 * std::sin(u);
    sweep.push_back(section(i, {0.0, -std::sin(turn), std::cos(turn)}, 50.0 + 9.0 * std::sin(3.0 * u),
                            {0.0, 4.0 * std::cos(u), 10.0 * u}));
  }
  const PlanarRepresentation plane = planar_representation(sweep);
  const auto flat = [](const Eigen::Vector3d& v) { return Eigen::Vector2d(v.z(), v.y()); };
  // The same up to a rotation and a reflection.
  const double sense = angle(plane.normals[0], plane.normals[9]) * angle(flat(sweep[0].normal), flat(sweep[9].normal));
  for (std::size_t i = 1; i < sweep.size(); ++i) {
    const double expected = angle(flat(sweep[0].normal), flat(sweep[i].normal));
    EXPECT_NEAR(angle(plane.normals[0], plane.normals[i]), sense > 0.0 ? expected : -expected, 1e-9) << i;
    EXPECT_NEAR((plane.centres[i] - plane.centres[0]).norm(), (sweep[i].centroid_mm - sweep[0].centroid_mm).norm(),
                1e-9);
  }
}

TEST(PlanarRepresentation, TurnsOnInTheSameSenseWhereTheAnglesLeaveItOpen) {
  // A symmetric fan: half way, a line stands straight across the way, and both sides are equally good.
  const Sections sweep = sphere_fan(10.0, 1.02, 9);
  const PlanarRepresentation plane = planar_representation(sweep);
  EXPECT_TRUE(plane.ambiguous);
  for (std::size_t i = 2; i + 1 < sweep.size(); ++i) {
    EXPECT_GT(angle(plane.normals[i - 1], plane.normals[i]) * angle(plane.normals[1], plane.normals[2]), 0.0);
  }
}

TEST(PlanarRepresentation, PassesOverStepsThatGoNowhere) {
  Sections sweep = sphere_linear(10.0, 8);
  sweep.insert(sweep.begin() + 4, sweep[4]);
  sweep.insert(sweep.begin(), sweep[0]);
  const PlanarRepresentation plane = planar_representation(sweep);
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    EXPECT_TRUE(plane.normals[i].allFinite());
    EXPECT_NEAR((plane.centres[i] - plane.centres[0]).norm(), sweep[i].centroid_mm.z() + 10.0, 1e-9);
    EXPECT_NEAR(plane.normals[i].norm(), std::abs(plane.normals[i].dot(plane.normals[5].normalized())), 1e-9);
  }
}

}  // namespace
}  // namespace fathom
