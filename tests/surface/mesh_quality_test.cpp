#include "surface/mesh_quality.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "surface/vertex_normals.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace shapes;
constexpr double kPi = std::numbers::pi;

TEST(TriangleQuality, OfAnEquilateralTriangleIsOneAtAnySizeAndPlace) {
  Random random(6);
  for (const double size : {1e-3, 1.0, 1e3}) {
    for (const double distance : {0.0, 1e3}) {
      const Eigen::Isometry3d motion = random_motion(random, distance);
      const TriangleQuality quality =
          triangle_quality(motion * Eigen::Vector3d(0, 0, 0), motion * Eigen::Vector3d(size, 0, 0),
                           motion * Eigen::Vector3d(0.5 * size, 0.5 * std::numbers::sqrt3 * size, 0));
      const double rounding = 1e-12 * (1.0 + distance / size);
      EXPECT_NEAR(quality.radius_ratio, 1.0, rounding);
      EXPECT_NEAR(quality.q_area, 1.0, rounding);
      EXPECT_NEAR(quality.smallest_angle_rad, kPi / 3.0, rounding);
      EXPECT_NEAR(quality.largest_angle_rad, kPi / 3.0, rounding);
      EXPECT_NEAR(quality.area_mm2, 0.25 * std::numbers::sqrt3 * size * size, rounding * size * size);
    }
  }
}

TEST(TriangleQuality, OfTheTriangleWithSides3And4And5) {
  const std::array<Eigen::Vector3d, 3> corners = {{{0, 0, 0}, {4, 0, 0}, {0, 0, 3}}};
  for (const auto& [i, j, k] :
       std::vector<std::array<std::size_t, 3>>{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    const TriangleQuality quality = triangle_quality(corners[i], corners[j], corners[k]);
    EXPECT_NEAR(quality.radius_ratio, 2.5 / 2.0, 1e-14);  // circles of radius 2.5 and 1
    EXPECT_NEAR(quality.q_area, 4.0 * std::numbers::sqrt3 * 6.0 / 50.0, 1e-14);
    EXPECT_NEAR(quality.smallest_angle_rad, std::atan2(3.0, 4.0), 1e-14);
    EXPECT_NEAR(quality.largest_angle_rad, kPi / 2.0, 1e-14);
    EXPECT_NEAR(quality.area_mm2, 6.0, 1e-14);
  }
}

TEST(TriangleQuality, OfThinTriangles) {
  // A needle of length 1 and base 2e: R = 1/2, r = e, nearly. A cap of length 2 and height e: R = 1 / (2 e), r = e/2.
  const double e = 1e-6;
  const TriangleQuality needle = triangle_quality({0, -e, 0}, {0, e, 0}, {1, 0, 0});
  EXPECT_NEAR(needle.radius_ratio * e, 0.25, 1e-5);
  EXPECT_NEAR(needle.smallest_angle_rad, 2.0 * e, 1e-11);
  EXPECT_NEAR(needle.largest_angle_rad, kPi / 2.0, 1e-5);
  const TriangleQuality cap = triangle_quality({-1, 0, 0}, {0, e, 0}, {1, 0, 0});
  EXPECT_NEAR(cap.radius_ratio * e * e, 0.5, 1e-5);
  EXPECT_NEAR(cap.smallest_angle_rad, e, 1e-11);
  EXPECT_NEAR(cap.largest_angle_rad, kPi - 2.0 * e, 1e-11);
}

TEST(TriangleQuality, WithoutAreaIsTheWorst) {
  for (const Eigen::Vector3d& third :
       {Eigen::Vector3d(2, 2, 2), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(.1, .1, .1)}) {
    const TriangleQuality quality = triangle_quality({0, 0, 0}, {1, 1, 1}, third);
    EXPECT_EQ(quality.radius_ratio, std::numeric_limits<double>::infinity());
    EXPECT_EQ(quality.q_area, 0.0);
    EXPECT_EQ(quality.area_mm2, 0.0);
    EXPECT_EQ(quality.smallest_angle_rad, 0.0);
  }
}

TEST(MeshQuality, CountsEveryTriangleOnce) {
  // Isosceles right-angled boxes' halves on a strip: 94 of sides 1, 1; 5 of sides 1, 4; 1 without area.
  Mesh mesh;
  for (std::int32_t t = 0; t < 100; ++t) {
    const double length = t < 94 ? 1.0 : t < 99 ? 4.0 : 0.0;
    mesh.vertices.insert(mesh.vertices.end(),
                         {{0, 0, 1.0 * t}, {1, 0, 1.0 * t}, {length < 0.5 ? 0.5 : 0, length, 1.0 * t}});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  // R is half the hypotenuse, r = (a + b - c) / 2.
  const double good = std::numbers::sqrt2 / (2.0 * (2.0 - std::numbers::sqrt2));
  const double poor = std::sqrt(17.0) / (2.0 * (5.0 - std::sqrt(17.0)));
  const MeshQuality quality = mesh_quality(mesh);
  EXPECT_NEAR(quality.radius_ratio_median, good, 1e-13);
  EXPECT_NEAR(quality.radius_ratio_p95, poor, 1e-13);
  EXPECT_EQ(quality.radius_ratio_max, std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(quality.above_2, 0.06);
  EXPECT_EQ(quality.zero_area_triangles, 1);
  EXPECT_EQ(quality.smallest_angle_rad, 0.0);
  EXPECT_NEAR(quality.largest_angle_rad, kPi, 1e-15);
  const double q_good = 2.0 * std::numbers::sqrt3 / 4.0;
  const double q_poor = 2.0 * std::numbers::sqrt3 * 4.0 / 34.0;
  EXPECT_NEAR(quality.q_area_p5, q_poor, 1e-13);
  EXPECT_NEAR(quality.q_area_median, q_good, 1e-13);
  EXPECT_NEAR(quality.q_area_mean, 0.94 * q_good + 0.05 * q_poor, 1e-13);
  // One more good one, and 95 % are good.
  mesh.triangles[95] = {0, 1, 2};
  EXPECT_NEAR(mesh_quality(mesh).radius_ratio_p95, good, 1e-13);
  EXPECT_THROW(mesh_quality({}), Error);
}

TEST(MeshQuality, OfASphereMadeOfNearlyEquilateralTriangles) {
  const MeshQuality quality = mesh_quality(icosphere(10.0, 4));
  EXPECT_LT(quality.radius_ratio_max, 1.1);
  EXPECT_GE(quality.radius_ratio_median, 1.0);
  EXPECT_LE(quality.radius_ratio_median, quality.radius_ratio_p95);
  EXPECT_LE(quality.radius_ratio_p95, quality.radius_ratio_max);
  EXPECT_EQ(quality.above_2, 0.0);
  EXPECT_EQ(quality.zero_area_triangles, 0);
}

TEST(VertexNormals, OfASphereAreRadialAndOfACubeDiagonal) {
  const Mesh sphere = icosphere(10.0, 4);
  const std::vector<Eigen::Vector3d> normals = vertex_normals(sphere);
  ASSERT_EQ(normals.size(), sphere.vertices.size());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    EXPECT_NEAR(normals[v].norm(), 1.0, 1e-14);
    EXPECT_GT(normals[v].dot(sphere.vertices[v]), 10.0 * std::cos(0.01));
  }
  // Weighted by area, a vertex of a long box looks where its largest faces do.
  const std::vector<Eigen::Vector3d> of_box = vertex_normals(box({0, 0, 0}, {1, 1, 100}));
  for (const Eigen::Vector3d& normal : of_box) EXPECT_LT(std::abs(normal.z()), 0.03);
  Mesh unused = tetrahedron();
  unused.vertices.emplace_back(9, 9, 9);
  EXPECT_TRUE(vertex_normals(unused).back().isZero());
}

}  // namespace
}  // namespace fathom
