#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/error.h"
#include "measurement/partition_surface.h"
#include "tests/measurement/ball_scans.h"

namespace fathom {
namespace {

using namespace ball_scans;

TEST(PartitionSurfaceWarnings, SweepsThatDisagreeAreSaidNotToMeet) {
  Random random(3);
  const TwoSweeps two = two_sweeps(random, 0.0);
  const FrameLocator locator = two.scan.locator();
  // The second sweep saw the ball 1 mm aside along the plane.
  const double aside = 1.0;
  const Eigen::Vector3d moved = two.scan.centre + aside * two.plane.normal().unitOrthogonal();
  Structure structure = ball(locator, two.scan.centre, kRadius);
  std::erase_if(structure.contours, [&](const Contour& c) { return c.frame >= two.scan.sweeps[1].first; });
  for (const Contour& contour : ball(locator, moved, kRadius).contours) {
    if (contour.frame >= two.scan.sweeps[1].first) structure.contours.push_back(contour);
  }
  const auto surface = partition_surface(structure, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(0.5));
  ASSERT_EQ(surface.planes.size(), 1u);
  // Two discs apart by d have in one only: 2 (pi r^2 - overlap).
  const double r = kRadius;
  const double overlap =
      2.0 * r * r * std::acos(aside / (2.0 * r)) - 0.5 * aside * std::sqrt(4.0 * r * r - aside * aside);
  EXPECT_NEAR(surface.planes[0].mismatch_mm2, 2.0 * (kPi * r * r - overlap), 4.0);
  ASSERT_EQ(surface.warnings.size(), 1u);
  EXPECT_NE(surface.warnings[0].find("do not meet at dividing plane 1"), std::string::npos);
  EXPECT_TRUE(surface.volume_ml.has_value());
}

TEST(PartitionSurfaceWarnings, OpenContoursThatEndBeyondThePlaneChangeNothing) {
  Random random(4);
  const TwoSweeps two = two_sweeps(random, 1.0, 21);
  const FrameLocator locator = two.scan.locator();
  const Structure closed = ball(locator, two.scan.centre, kRadius);
  Structure open = closed;
  int opened = 0;
  for (Contour& contour : open.contours) {
    // What lies more than 2 mm beyond the plane is left out, where it is one stretch.
    const bool first = contains(two.scan.sweeps[0], contour.frame);
    const Eigen::Affine3d map = *locator.reference_from_image(contour.frame);
    const auto keep = [&](const Eigen::Vector2d& point) {
      const double above = two.plane.signedDistance(map * Eigen::Vector3d(point.x(), point.y(), 0.0));
      return (first ? above : -above) > -2.0;
    };
    const auto gone = std::find_if_not(contour.points_px.begin(), contour.points_px.end(), keep);
    if (gone == contour.points_px.end()) continue;
    std::rotate(contour.points_px.begin(), gone, contour.points_px.end());
    const auto start = std::find_if(contour.points_px.begin(), contour.points_px.end(), keep);
    Polygon kept(start, contour.points_px.end());
    std::erase_if(kept, [&](const Eigen::Vector2d& point) { return !keep(point); });
    if (kept.size() < 3) continue;
    contour.points_px = kept;
    contour.closed = false;
    ++opened;
  }
  ASSERT_GT(opened, 10);
  const auto whole = partition_surface(closed, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(0.5));
  const auto part = partition_surface(open, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(0.5));
  EXPECT_NEAR(*part.volume_ml, *whole.volume_ml, 0.005 * kBall_ml);
  EXPECT_TRUE(part.warnings.empty());
}

TEST(PartitionSurfaceWarnings, AnOpenContourWhoseEndsAreJoinedInItsOwnPartIsSaid) {
  Random random(4);
  const TwoSweeps two = two_sweeps(random, 0.0, 11);
  const FrameLocator locator = two.scan.locator();
  Structure structure = ball(locator, two.scan.centre, kRadius);
  Contour& contour = structure.contours[5];
  const Eigen::Affine3d map = *locator.reference_from_image(contour.frame);
  const auto above = [&](const Eigen::Vector2d& point) {
    return two.plane.signedDistance(map * Eigen::Vector3d(point.x(), point.y(), 0.0));
  };
  const auto highest = std::max_element(contour.points_px.begin(), contour.points_px.end(),
                                        [&](const auto& a, const auto& b) { return above(a) < above(b); });
  ASSERT_GT(above(*highest), 3.0);
  std::rotate(contour.points_px.begin(), highest, contour.points_px.end());
  contour.closed = false;
  const auto surface = partition_surface(structure, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(1.0));
  ASSERT_FALSE(surface.warnings.empty());
  EXPECT_EQ(surface.warnings[0].find("frame " + std::to_string(contour.frame) + ": the open contour"), 0u)
      << surface.warnings[0];
}

TEST(PartitionSurfaceWarnings, ASweepThatWasNotOutlinedLeavesNoSum) {
  Random random(6);
  const TwoSweeps two = two_sweeps(random, 0.0, 15);
  const FrameLocator locator = two.scan.locator();
  Structure structure = ball(locator, two.scan.centre, kRadius);
  std::erase_if(structure.contours, [&](const Contour& c) { return c.frame >= two.scan.sweeps[1].first; });
  const auto surface = partition_surface(structure, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(1.0));
  ASSERT_EQ(surface.parts.size(), 1u);
  EXPECT_TRUE(surface.parts[0].volume_ml.has_value());
  EXPECT_FALSE(surface.volume_ml.has_value());
  ASSERT_FALSE(surface.warnings.empty());
  EXPECT_NE(surface.warnings.back().find("sweep 2"), std::string::npos) << surface.warnings.back();
  // One frame is worse than none.
  structure.contours.push_back(ball(locator, two.scan.centre, kRadius).contours.back());
  EXPECT_THROW(partition_surface(structure, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(1.0)), Error);
}

TEST(PartitionSurfaceWarnings, SweepsThatSeeOtherHalvesHaveNoSum) {
  // The first sweep sees what is left of a plane, the second what is right; the dividing plane stands across.
  const std::vector<double> places = evenly(-9.99, 9.99, 30);
  const FrameLocator locator = scan_of(turning_sweep(places), 0.1);
  const std::vector<Sweep> sweeps{{0, 0, 14}, {0, 15, 29}};
  const SpacePartition partition({one_centre({-30, 0, -5}), one_centre({30, 0, 5})},
                                 {DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  const auto surface = partition_surface(ball(locator, Eigen::Vector3d::Zero(), kRadius), {&locator, 1},
                                         {sweeps, partition}, spaced(0.5));
  EXPECT_EQ(surface.parts.size(), 2u);
  EXPECT_FALSE(surface.volume_ml.has_value()) << "it would be half the ball";
  EXPECT_NE(surface.warnings.back().find("most of the cut at dividing plane 1"), std::string::npos);
}

TEST(PartitionSurfaceWarnings, PlanesThatGrazeTheBallSpoilNothing) {
  Random random(21);
  for (const double height : {9.6, 9.9, 9.99}) {
    const TwoSweeps two = two_sweeps(random, height);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), {&locator, 1},
                                           {two.scan.sweeps, two.partition}, spaced(0.5, GapOrder::kCurved));
    ASSERT_TRUE(surface.volume_ml.has_value()) << height;
    EXPECT_NEAR(*surface.volume_ml, kBall_ml, 0.006 * kBall_ml);
  }
}

TEST(PartitionSurfaceWarnings, OutlinesThatEndShortOfThePlaneAreSaidWithWhatIsMissing) {
  // Both sweeps along z, the first from below to 1 mm short of the plane at 2 mm, the second from 3 mm short of it on.
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Sweep> sweeps;
  for (const auto& [from, to] : {std::pair(-9.99, 1.0), std::pair(5.0, 9.99)}) {
    const int first = static_cast<int>(poses.size());
    for (const Eigen::Isometry3d& pose : turning_sweep(evenly(from, to, 15))) poses.push_back(pose);
    sweeps.push_back({0, first, static_cast<int>(poses.size()) - 1});
  }
  const FrameLocator locator = scan_of(poses, 0.1);
  const SpacePartition partition({one_centre({0, 0, -30}), one_centre({0, 0, 30})},
                                 {DividingPlane(Eigen::Vector3d::UnitZ(), -2.0)});
  const auto surface = partition_surface(ball(locator, Eigen::Vector3d::Zero(), kRadius), {&locator, 1},
                                         {sweeps, partition}, spaced(0.5));
  EXPECT_TRUE(surface.planes.empty()) << "nothing is cut";
  const double first_ml = kPi * (kRadius * kRadius - 1.0) * 1.0 / 1000.0;
  const double second_ml = kPi * (kRadius * kRadius - 25.0) * 3.0 / 1000.0;
  ASSERT_EQ(surface.warnings.size(), 2u);
  char expected[200];
  std::snprintf(expected, sizeof expected, "sweep 1 end on frame 14, 1 mm short of dividing plane 1: about %.2g ml",
                first_ml);
  EXPECT_NE(surface.warnings[0].find(expected), std::string::npos) << surface.warnings[0];
  std::snprintf(expected, sizeof expected, "sweep 2 end on frame 15, 3 mm short of dividing plane 1: about %.2g ml",
                second_ml);
  EXPECT_NE(surface.warnings[1].find(expected), std::string::npos) << surface.warnings[1];

  // Where the user looked beyond the first sweep's outlines and saw nothing, nothing is missing.
  Structure marked = ball(locator, Eigen::Vector3d::Zero(), kRadius);
  std::erase_if(marked.contours, [](const Contour& contour) { return contour.frame == 14; });
  marked.absent.push_back({.frame = 14});
  const auto ended = partition_surface(marked, {&locator, 1}, {sweeps, partition}, spaced(0.5));
  EXPECT_TRUE(std::none_of(ended.warnings.begin(), ended.warnings.end(), [](const std::string& warning) {
    return warning.find("sweep 1 end on frame") != std::string::npos;
  }));
}

TEST(PartitionSurfaceWarnings, SeveralSweepsWithoutPlanesAreRefused) {
  Random random(6);
  const TwoSweeps two = two_sweeps(random, 0.0, 9);
  const FrameLocator locator = two.scan.locator();
  EXPECT_THROW(partition_surface(ball(locator, two.scan.centre, kRadius), {&locator, 1},
                                 {two.scan.sweeps, SpacePartition(two.partition.sweeps())}, {}),
               Error);
}

}  // namespace
}  // namespace fathom
