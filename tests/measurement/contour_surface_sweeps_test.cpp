#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"
#include "measurement/contour_surface.h"
#include "tests/measurement/surface_checks.h"

namespace fathom {
namespace {

using surfaces::expect_sound;
using surfaces::kCentre;
using surfaces::kPi;
using surfaces::kRadius;
using surfaces::stack_of_cones_mm3;

TEST(ContourSurface, OfASweepThatTurnsBackCountsTheBallOnce) {
  std::vector<double> places = evenly(-9.5, 4.0, 10);
  for (const double back : evenly(2.5, -5.0, 6)) places.push_back(back);
  for (const double again : evenly(-3.5, 9.5, 9)) places.push_back(again);
  const FrameLocator locator = scan_of(turning_sweep(places), 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  expect_sound(surface.mesh());
  EXPECT_EQ(std::count(surface.mesh().sweep_signs.begin(), surface.mesh().sweep_signs.end(), -1) > 0, true);
  ASSERT_FALSE(surface.warnings().empty());
  EXPECT_NE(surface.warnings().back().find("backward"), std::string::npos);
  ContourSurface once(locator, {});
  Structure forward = ball(locator, kCentre, kRadius);
  std::erase_if(forward.contours, [&](const Contour& contour) { return contour.frame >= 7 && contour.frame < 19; });
  once.update(forward);
  EXPECT_NEAR(*surface.volume_ml() / *once.volume_ml(), 1.0, 0.02);
}

TEST(ContourSurface, OfPlanesThatCrossInTheObjectCountsWhatWasSweptTwiceOnce) {
  // An unsteady hand: planes 1 mm apart tilt against each other by up to 8 degrees and cross in the ball.
  std::vector<Eigen::Isometry3d> poses = turning_sweep(evenly(-9.0, 9.0, 19));
  Random random(3);
  for (Eigen::Isometry3d& pose : poses) {
    pose.rotate(Eigen::AngleAxisd(0.08 * random.normal(), Eigen::Vector3d::UnitX()));
  }
  const FrameLocator locator = scan_of(poses, 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  expect_sound(surface.mesh());
  const std::vector<double> places = evenly(-9.0, 9.0, 19);
  EXPECT_NEAR(*surface.volume_ml() / (stack_of_cones_mm3(places) / 1000.0), 1.0, 0.05);
}

TEST(ContourSurface, OfARotationalSweepHasNoVolume) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 12; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(kCentre);
    pose.rotate(Eigen::AngleAxisd(kPi * i / 11, Eigen::Vector3d::UnitX()));
    poses.push_back(pose);
  }
  const FrameLocator locator = scan_of(poses, 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  EXPECT_FALSE(surface.volume_ml().has_value());
}

}  // namespace
}  // namespace fathom
