#include "surface/convex_clip.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

using Plane = Eigen::Hyperplane<double, 3>;

Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

// A star, far from convex, in a plane of any direction.
Polygon3 random_star(Random& random) {
  const Eigen::Vector3d normal = random_direction(random);
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d up = normal.cross(across);
  const int corners = 3 + static_cast<int>(random.uniform(0, 20));
  Polygon3 star;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    const double radius = random.uniform(5, 50);
    star.push_back(radius * (std::cos(angle) * across + std::sin(angle) * up));
  }
  return star;
}

TEST(ConvexClip, AreasOfThePartsOfRandomPolygonsAddUpToTheWhole) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Polygon3 polygon = random_star(random);
    std::vector<Polygon3> parts{polygon};
    const int planes = 1 + trial % 6;
    for (int j = 0; j < planes; ++j) {
      const Plane plane(random_direction(random), random.uniform(-20, 20));
      std::vector<Polygon3> cut;
      for (const Polygon3& part : parts) {
        const SplitPolygon split = split_polygon(part, plane);
        for (const Eigen::Vector3d& point : split.positive) EXPECT_GE(plane.signedDistance(point), -1e-10);
        for (const Eigen::Vector3d& point : split.negative) EXPECT_LE(plane.signedDistance(point), 1e-10);
        cut.push_back(split.positive);
        cut.push_back(split.negative);
      }
      parts = cut;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Polygon3& part : parts) sum += vector_area(part);
    const Eigen::Vector3d whole = vector_area(polygon);
    EXPECT_LT((sum - whole).norm(), 1e-9 * whole.norm()) << "trial " << trial;
  }
}

TEST(ConvexClip, APolygonInThePlaneIsNotLost) {
  const Polygon3 square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const SplitPolygon split = split_polygon(square, Plane(Eigen::Vector3d::UnitZ(), 0.0));
  EXPECT_EQ(split.positive.size(), 4u);
  EXPECT_TRUE(split.negative.empty());
}

TEST(ConvexClip, LinesComeBackInPieces) {
  const Polygon3 zigzag{{0, -1, 0}, {1, 1, 0}, {2, -1, 0}, {3, 1, 0}, {4, 1, 0}};
  const auto pieces = clip_line(zigzag, {Plane(Eigen::Vector3d::UnitY(), 0.0)});
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_TRUE(pieces[0].front().isApprox(Eigen::Vector3d(0.5, 0, 0)));
  EXPECT_TRUE(pieces[0].back().isApprox(Eigen::Vector3d(1.5, 0, 0)));
  EXPECT_TRUE(pieces[1].back().isApprox(Eigen::Vector3d(4, 1, 0)));
}

// The faces of a body are not oriented: their pyramids about a point inside all count positive.
double volume(const ConvexBody& body) {
  const Eigen::Vector3d inside = middle(body);
  double sum = 0.0;
  for (const Polygon3& face : body.faces) sum += std::abs(vector_area(face).dot(face[0] - inside)) / 3.0;
  return sum;
}

TEST(ConvexClip, VolumesOfThePartsOfBodiesAddUpToTheWhole) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<ConvexBody> parts{make_cube({3, -2, 1}, 10.0)};
    for (int j = 0; j < 6; ++j) {
      const Plane plane(random_direction(random), random.uniform(-5, 5));
      std::vector<ConvexBody> cut;
      for (const ConvexBody& part : parts) {
        SplitBody split = split_body(part, plane, 1e-6);
        if (!split.positive.faces.empty()) cut.push_back(split.positive);
        if (!split.negative.faces.empty()) cut.push_back(split.negative);
      }
      parts = cut;
    }
    double sum = 0.0;
    for (const ConvexBody& part : parts) sum += volume(part);
    EXPECT_NEAR(sum, 8000.0, 8000.0 * 1e-9) << "trial " << trial;
  }
}

}  // namespace
}  // namespace fathom
