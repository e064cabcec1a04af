#include "segmentation/least_bent.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr double kRadius_px = 60.0;
constexpr double kStep_rad = 2.0 / kRadius_px;  // points 2 pixels apart

Eigen::Vector2d on_arc(int i) { return kRadius_px * Eigen::Vector2d(std::cos(i * kStep_rad), std::sin(i * kStep_rad)); }

TEST(LeastBent, AStretchWithoutWeightGoesOnAsAnArc) {
  // A gap of 80 pixels: its chord passes 13 pixels inside of the arc.
  std::vector<WantedPoint> wanted;
  for (int i = 0; i < 100; ++i) {
    const bool seen = i < 30 || i >= 70;
    wanted.push_back({seen ? on_arc(i) : Eigen::Vector2d(0.0, 0.0), seen ? 1.0 : 1e-9});
  }
  const Polygon line = least_bent(wanted, 100.0);
  ASSERT_EQ(line.size(), wanted.size());
  for (const Eigen::Vector2d& point : line) EXPECT_NEAR(point.norm(), kRadius_px, 0.3);
}

// Where nothing is seen between two seeds the points stay on their parabola, however coarse the edges' scale makes it.
TEST(LeastBent, IsNeverLeftToRounding) {
  for (const double stiffness : {5e6, 6e7, 1.3e9, 2e13}) {
    for (const int count : {4, 10, 50, 500}) {
      std::vector<WantedPoint> wanted;
      for (int i = 0; i < count; ++i) wanted.push_back({{2.0 * i, 1e-3 * i * (count - 1 - i)}, 1e-6});
      const Polygon line = least_bent(wanted, stiffness);
      for (std::size_t i = 0; i < line.size(); ++i) {
        EXPECT_NEAR((line[i] - wanted[i].place_px).norm(), 0.0, 0.5) << stiffness << " " << count << " " << i;
      }
    }
  }
}

TEST(LeastBent, BendsShorterThanTheStiffnessAllowsAreEvenedOutByTheirFilter) {
  // Of a wave of frequency w, third differences leave 1 / (1 + stiffness (2 sin(w / 2))^6), far from the ends.
  for (const double wave_points : {10.0, 20.0, 40.0}) {
    const double frequency = 2.0 * 3.14159265358979 / wave_points;
    std::vector<WantedPoint> wanted;
    for (int i = 0; i <= 400; ++i) wanted.push_back({{2.0 * i, std::cos(frequency * (i - 200))}, 1.0});
    constexpr double kStiffness = 50.0;
    const double left = 1.0 / (1.0 + kStiffness * std::pow(2.0 * std::sin(0.5 * frequency), 6));
    EXPECT_NEAR(least_bent(wanted, kStiffness)[200].y(), left, 1e-4) << wave_points;
  }
}

TEST(LeastBent, EndsStayAndParabolasAreLeftAlone) {
  std::vector<WantedPoint> wanted;
  for (int i = 0; i < 40; ++i) wanted.push_back({{2.0 * i, 0.05 * i * i}, 0.5});
  wanted[20].place_px.y() += 3.0;
  wanted[20].weight = 0.0;
  const Polygon line = least_bent(wanted, 1e4);
  for (int i = 0; i < 40; ++i) EXPECT_NEAR(line[static_cast<std::size_t>(i)].y(), 0.05 * i * i, 1e-4);
  wanted.front().weight = 0.0;
  wanted.front().place_px.y() = 7.0;
  EXPECT_NEAR(least_bent(wanted, 1e4).front().y(), 7.0, 1e-4);
}

}  // namespace
}  // namespace fathom
