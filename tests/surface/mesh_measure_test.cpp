#include "surface/mesh_measure.h"

#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "surface/mesh_check.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace shapes;
constexpr double kPi = std::numbers::pi;
using Normals = std::vector<Eigen::Vector3d>;

void expect_refused(const std::function<void()>& measure, const std::string& words) {
  try {
    measure();
    ADD_FAILURE() << "measured; expected " << words;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Area, OfSolids) {
  EXPECT_NEAR(area_mm2(tetrahedron()), 1.5 + 0.5 * std::numbers::sqrt3, 1e-14);
  EXPECT_NEAR(area_mm2(box({0, 0, 0}, {1, 2, 3})), 22.0, 1e-13);
  EXPECT_EQ(area_mm2({}), 0.0);
}

TEST(Volume, OfSolidsWithFlatFaces) {
  EXPECT_NEAR(volume_mm3(tetrahedron()), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(volume_mm3(box({-1, 2, -3}, {4, 4, 5})), 80.0, 1e-12);
  EXPECT_NEAR(volume_mm3(joined(tetrahedron(), box({5, 5, 5}, {6, 6, 6}))), 7.0 / 6.0, 1e-13);
}

TEST(Volume, OfARoundSolidComesNearerWithTheSquareOfTheSpacing) {
  const double ball = 4.0 / 3.0 * kPi * 1000.0;
  const double sphere = 4.0 * kPi * 100.0;
  for (int divisions = 2; divisions < 5; ++divisions) {
    const Mesh coarse = icosphere(10.0, divisions);
    const Mesh fine = icosphere(10.0, divisions + 1);
    EXPECT_NEAR((ball - volume_mm3(coarse)) / (ball - volume_mm3(fine)), 4.0, 0.1);
    EXPECT_NEAR((sphere - area_mm2(coarse)) / (sphere - area_mm2(fine)), 4.0, 0.1);
  }
  const double ring = 2.0 * kPi * kPi * 10.0 * 9.0;
  EXPECT_NEAR((ring - volume_mm3(torus(10.0, 3.0, 60, 30))) / (ring - volume_mm3(torus(10.0, 3.0, 120, 60))), 4.0, 0.1);
}

TEST(Volume, IsNegativeInsideOutAndInWhatWasSweptBackward) {
  const Mesh ball = icosphere(10.0, 3);
  const double volume = volume_mm3(ball);
  EXPECT_DOUBLE_EQ(volume_mm3(turned_inside_out(ball)), -volume);
  // A ball of 10 passed forward, and one of 5 passed backward.
  Mesh both = joined(ball, shifted(icosphere(5.0, 3), {20.0, 0.0, 0.0}));
  both.sweep_signs.assign(both.triangles.size(), 1);
  EXPECT_NEAR(volume_mm3(both), 1.125 * volume, 1e-9 * volume);
  std::fill(both.sweep_signs.begin() + both.sweep_signs.size() / 2, both.sweep_signs.end(), std::int8_t{-1});
  EXPECT_NEAR(volume_mm3(both), 0.875 * volume, 1e-9 * volume);
  EXPECT_NEAR(projected_volume_mm3(both, {}), 0.875 * volume, 1e-9 * volume);
  EXPECT_NEAR(area_mm2(both), 1.25 * area_mm2(ball), 1e-9 * area_mm2(ball));
}

TEST(Volume, DoesNotChangeWhenTheMeshIsTurnedAndMovedByTenMetres) {
  Random random(3);
  for (const Mesh& mesh : {icosphere(20.0, 4), torus(30.0, 9.0, 80, 40), box({0, 0, 0}, {10, 20, 30}), tetrahedron()}) {
    for (int round = 0; round < 20; ++round) {
      const Eigen::Isometry3d motion = random_motion(random, 1e4);
      const Mesh far = moved(mesh, motion);
      EXPECT_NEAR(volume_mm3(far), volume_mm3(mesh), 1e-9 * volume_mm3(mesh));
      EXPECT_NEAR(projected_volume_mm3(far, {}), volume_mm3(mesh), 1e-9 * volume_mm3(mesh));
      EXPECT_NEAR(area_mm2(far), area_mm2(mesh), 1e-9 * area_mm2(mesh));
      EXPECT_LT((centroid_mm(far) - motion * centroid_mm(mesh)).norm(), 1e-7);
    }
  }
}

TEST(Centroid, OfSolids) {
  EXPECT_LT((centroid_mm(tetrahedron()) - Eigen::Vector3d::Constant(0.25)).norm(), 1e-14);
  EXPECT_LT((centroid_mm(turned_inside_out(tetrahedron())) - Eigen::Vector3d::Constant(0.25)).norm(), 1e-14);
  // Vertices crowd on one side, where the small box is, but volumes weigh.
  const Mesh two = joined(box({0, 0, 0}, {2, 2, 2}), shifted(box({0, 0, 0}, {1, 1, 1}), {8.5, 0.5, 0.5}));
  EXPECT_LT((centroid_mm(two) - Eigen::Vector3d(17.0 / 9.0, 1.0, 1.0)).norm(), 1e-13);
}

TEST(Volume, IsRefusedWhereThereIsNone) {
  const auto refused = [](const Mesh& mesh, const std::string& words) {
    expect_refused([&] { volume_mm3(mesh); }, words);
    expect_refused([&] { centroid_mm(mesh); }, words);
    expect_refused([&] { projected_volume_mm3(mesh, {}); }, words);
  };
  refused({}, "no triangles");
  Mesh mesh = icosphere(10.0, 1);
  mesh.triangles.pop_back();
  refused(mesh, "open (3 boundary edges)");
  mesh = icosphere(10.0, 1);
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  refused(mesh, "inside out in places (3 edges");
  refused(moebius_strip(15), "inside out in places");
  mesh = joined(tetrahedron(), tetrahedron());
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex = vertex == 4 || vertex == 7 ? vertex - 4 : vertex;
  }
  refused(mesh, "branches at 1 edge with");
  mesh = joined(tetrahedron(), tetrahedron());
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex = vertex == 4 ? 0 : vertex;
  }
  refused(mesh, "pinched at 1 vertex");
  Mesh flat = tetrahedron();
  flat.vertices[3] = {0.25, 0.25, 0.0};
  EXPECT_EQ(volume_mm3(flat), 0.0);
  expect_refused([&] { centroid_mm(flat); }, "no volume");
}

TEST(ProjectedVolume, OfABoxCutByObliquePlanes) {
  const Mesh whole = box({0, 0, 0}, {2, 2, 3});
  const Eigen::Vector3d first(1.0, 0.4, 0.0);
  const Eigen::Vector3d second(0.0, 0.25, 1.0);
  const Mesh once = cut(whole, first, 1.0);
  const Mesh twice = cut(once, second, 1.0);  // the cuts meet: one loop follows both
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    const Eigen::Isometry3d motion = round == 0 ? Eigen::Isometry3d::Identity() : random_motion(random, 1e4);
    const Normals one = {3.0 * (motion.linear() * first)};
    const Normals two = {motion.linear() * first, -0.2 * (motion.linear() * second)};
    EXPECT_NEAR(projected_volume_mm3(moved(whole, motion), {}), 12.0, 1e-8);
    EXPECT_NEAR(projected_volume_mm3(moved(whole, motion), two), 12.0, 1e-8);
    EXPECT_NEAR(projected_volume_mm3(moved(once, motion), one), 8.4, 1e-8);
    EXPECT_NEAR(projected_volume_mm3(moved(once, motion), two), 8.4, 1e-8);
    EXPECT_NEAR(projected_volume_mm3(moved(twice, motion), two), 6.1 + 0.8 / 3.0, 1e-8);
  }
}

TEST(ProjectedVolume, OfABallCutByPlanes) {
  const double r = 10.0;
  const Mesh ball = icosphere(r, 5);
  const double lost = volume_mm3(ball) / (4.0 / 3.0 * kPi * r * r * r);  // of the volume, by flat triangles
  EXPECT_GT(lost, 0.998);
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 1.0, 1.0).normalized();  // where (B.10) as printed fails
  const Eigen::Vector3d other = Eigen::Vector3d(-0.3, 0.7, 0.1).normalized();

  const double half = 2.0 / 3.0 * kPi * r * r * r;
  EXPECT_NEAR(projected_volume_mm3(cut(ball, axis, 1e-7), Normals{axis}), lost * half, 1e-4 * half);

  // Between parallel planes, 3 on one side of the centre and 5 on the other.
  const Mesh slab = cut(cut(ball, axis, -3.0 + 1e-7), -axis, -5.0 + 1e-7);
  const double of_slab = kPi * (r * r * 8.0 - (125.0 + 27.0) / 3.0);
  EXPECT_NEAR(projected_volume_mm3(slab, Normals{axis}), lost * of_slab, 1e-3 * of_slab);
  EXPECT_NEAR(projected_volume_mm3(slab, Normals{axis, -axis}), lost * of_slab, 1e-3 * of_slab);

  // The wedge between two planes through the centre: the angle between them is that of the normals, from 180 degrees.
  const double wedge = 2.0 / 3.0 * r * r * r * (kPi - std::acos(axis.dot(other)));
  const Mesh part = cut(cut(ball, axis, 1e-7), other, 1e-7);
  EXPECT_NEAR(projected_volume_mm3(part, Normals{axis, other}), lost * wedge, 1e-3 * wedge);
  EXPECT_NEAR(projected_volume_mm3(turned_inside_out(part), Normals{axis, other}), -lost * wedge, 1e-3 * wedge);
}

TEST(ProjectedVolume, IsRefusedWhereTheBoundaryLiesInNoPlane) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Mesh half = cut(icosphere(10.0, 3), z, 0.01);
  EXPECT_NO_THROW(projected_volume_mm3(half, Normals{z}));
  EXPECT_NO_THROW(projected_volume_mm3(half, Normals{x, z}));
  expect_refused([&] { projected_volume_mm3(half, {}); }, "open (");
  expect_refused([&] { projected_volume_mm3(half, Normals{x}); }, "open edge");
  expect_refused([&] { projected_volume_mm3(half, Normals{x, y}); }, "open edge");
  expect_refused([&] { projected_volume_mm3(half, Normals{z + 1e-3 * x}); }, "open edge");
  Mesh with_hole = half;
  with_hole.triangles.pop_back();
  expect_refused([&] { projected_volume_mm3(with_hole, Normals{z}); }, "open edge");
  // Every edge of this opening is normal to x or y, but no two planes cut a box so.
  Mesh open = box({0, 0, 0}, {1, 1, 1});
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);
  EXPECT_NEAR(projected_volume_mm3(open, Normals{z}), 1.0, 1e-15);
  expect_refused([&] { projected_volume_mm3(open, Normals{x, y}); }, "open edge");

  expect_refused([&] { projected_volume_mm3(half, Normals{x, y, z}); }, "3 planes");
  expect_refused([&] { projected_volume_mm3(half, Normals{Eigen::Vector3d::Zero()}); }, "no normal");
  expect_refused(
      [&] {
        projected_volume_mm3(half, Normals{z, z * std::numeric_limits<double>::quiet_NaN()});
      },
      "no normal");
  expect_refused([&] { projected_volume_mm3(moebius_strip(15), Normals{z}); }, "inside out");
}

}  // namespace
}  // namespace fathom
