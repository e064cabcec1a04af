#include "surface/exact_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

__extension__ typedef __int128 Wide;

int sign_of(Wide value) { return (value > 0) - (value < 0); }

// Few bits set, so that many points lie on a line or in a plane; up to 2^bits.
std::int64_t sparse(Random& random, int bits) {
  const auto small = static_cast<std::int64_t>(random.uniform(-3.0, 4.0));
  return small * (std::int64_t{1} << static_cast<int>(random.uniform(0.0, bits - 2.0)));
}

TEST(ExactOrientation, InThePlaneIsThatOfIntegers) {
  Random random(10);
  int on_line = 0;
  int doubtful = 0;
  for (int round = 0; round < 20000; ++round) {
    // Sums of sparse numbers with up to 53 bits each; their differences need more than a double has.
    std::array<std::array<Wide, 2>, 3> exact;
    std::array<Eigen::Vector2d, 3> points;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::int64_t value = sparse(random, 59);
        exact[i][k] = value;
        points[i][static_cast<Eigen::Index>(k)] = static_cast<double>(value);
      }
    }
    if (round % 2 == 0) {  // the third point near the line through the others and the origin
      exact[2] = {exact[0][0] + exact[1][0], exact[0][1] + exact[1][1]};
      exact[0] = {-exact[0][0], -exact[0][1]};
      exact[1] = {0, 0};
      points = {-points[0], Eigen::Vector2d::Zero(), points[0] + points[1]};
      if (static_cast<Wide>(points[2].x()) != exact[2][0] || static_cast<Wide>(points[2].y()) != exact[2][1]) continue;
    }
    const Wide determinant = (exact[1][0] - exact[0][0]) * (exact[2][1] - exact[0][1]) -
                             (exact[1][1] - exact[0][1]) * (exact[2][0] - exact[0][0]);
    EXPECT_EQ(orientation(points[0], points[1], points[2]), sign_of(determinant));
    const int certain = certain_orientation(points[0], points[1], points[2]);
    EXPECT_TRUE(certain == 0 || certain == sign_of(determinant));
    on_line += determinant == 0;
    doubtful += determinant != 0 && certain == 0;
  }
  EXPECT_GT(on_line, 500);
  EXPECT_GT(doubtful, 5);
}

TEST(ExactOrientation, InSpaceIsThatOfIntegers) {
  Random random(11);
  int in_plane = 0;
  for (int round = 0; round < 20000; ++round) {
    std::array<std::array<Wide, 3>, 4> exact;
    std::array<Eigen::Vector3d, 4> points;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t value = sparse(random, 38);
        exact[i][k] = value;
        points[i][static_cast<Eigen::Index>(k)] = static_cast<double>(value);
      }
    }
    std::array<std::array<Wide, 3>, 3> d;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) d[i][k] = exact[i + 1][k] - exact[0][k];
    }
    const Wide determinant = d[2][0] * (d[0][1] * d[1][2] - d[0][2] * d[1][1]) +
                             d[2][1] * (d[0][2] * d[1][0] - d[0][0] * d[1][2]) +
                             d[2][2] * (d[0][0] * d[1][1] - d[0][1] * d[1][0]);
    EXPECT_EQ(orientation(points[0], points[1], points[2], points[3]), sign_of(determinant));
    in_plane += determinant == 0;
  }
  EXPECT_GT(in_plane, 200);
}

TEST(ExactOrientation, TellsAPointOfAPlaneFromItsNeighbours) {
  // In x + y + z = 3; the differences of coordinates are not doubles.
  const Eigen::Vector3d p(1.0 + 0x1p-52, 1.0 - 0x1p-51, 1.0 + 0x1p-52);
  std::array<Eigen::Vector3d, 3> corners = {{{9, -3, -3}, {-3, 9, -3}, {-3, -3, 9}}};
  for (int turn = 0; turn < 3; ++turn) {
    const auto& [a, b, c] = corners;
    EXPECT_EQ(orientation(a, b, c, p), 0);
    EXPECT_EQ(orientation(p, a, c, b), 0);
    for (Eigen::Index k = 0; k < 3; ++k) {
      Eigen::Vector3d above = p;
      Eigen::Vector3d below = p;
      above[k] = std::nextafter(p[k], 9.0);
      below[k] = std::nextafter(p[k], -9.0);
      EXPECT_EQ(orientation(a, b, c, above), 1);
      EXPECT_EQ(orientation(a, b, c, below), -1);
      EXPECT_EQ(orientation(b, a, c, above), -1);
      EXPECT_EQ(orientation(above, b, c, a), -1);
      EXPECT_EQ(orientation(a, above, b, c), 1);
    }
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  }
}

}  // namespace
}  // namespace fathom
