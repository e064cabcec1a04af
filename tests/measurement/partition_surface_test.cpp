#include "measurement/partition_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "surface/mesh_measure.h"
#include "tests/measurement/ball_scans.h"

namespace fathom {
namespace {

using namespace ball_scans;

TEST(PartitionSurface, PartsOfABallSeenByTwoSweepsAreItsSegments) {
  Random random(1);
  for (const double height : {-6.0, 0.0, 3.0, 7.0}) {
    SCOPED_TRACE(height);
    const TwoSweeps two = two_sweeps(random, height);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), {&locator, 1},
                                           {two.scan.sweeps, two.partition}, spaced(0.5, GapOrder::kCurved));
    ASSERT_EQ(surface.parts.size(), 2u);
    for (const PartSurface& part : surface.parts) {
      expect_closed(part.surface.mesh);
      const double truth = segment_ml(part.sweep == 0 ? height : -height);
      EXPECT_NEAR(*part.volume_ml, truth, 0.005 * kBall_ml) << "sweep " << part.sweep;
      EXPECT_EQ(part.planes, std::vector<std::size_t>{0});
      EXPECT_NEAR(cap_area_mm2(part.surface, 0), kPi * (kRadius * kRadius - height * height), 5.0);
    }
    EXPECT_NEAR(*surface.volume_ml, kBall_ml, 0.006 * kBall_ml);
    EXPECT_NEAR(volume_mm3(surface.mesh()) / 1000.0, *surface.volume_ml, 1e-9);
    ASSERT_EQ(surface.planes.size(), 1u);
    EXPECT_LT(surface.planes[0].mismatch_share(), 0.03);
    EXPECT_TRUE(surface.warnings.empty());
  }
}

TEST(PartitionSurfaceStudy, PartsOfABallUnderRandomPlanesAndSweeps) {
  Random random(17);
  double worst_part = 0.0;
  double worst_total = 0.0;
  double worst_mismatch = 0.0;
  for (int round = 0; round < 100; ++round) {
    const double height = random.uniform(-8.0, 8.0);
    const TwoSweeps two = two_sweeps(random, height);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), {&locator, 1},
                                           {two.scan.sweeps, two.partition}, spaced(0.5, GapOrder::kCurved));
    for (const PartSurface& part : surface.parts) {
      const double truth = segment_ml(part.sweep == 0 ? height : -height);
      worst_part = std::max(worst_part, std::abs(*part.volume_ml - truth) / kBall_ml);
    }
    worst_total = std::max(worst_total, std::abs(*surface.volume_ml - kBall_ml) / kBall_ml);
    worst_mismatch = std::max(worst_mismatch, surface.planes[0].mismatch_share());
  }
  RecordProperty("worst_part", std::to_string(worst_part));
  RecordProperty("worst_total", std::to_string(worst_total));
  RecordProperty("worst_mismatch", std::to_string(worst_mismatch));
  EXPECT_LT(worst_part, 0.005);
  EXPECT_LT(worst_total, 0.005);
  EXPECT_LT(worst_mismatch, 0.05);
}

TEST(PartitionSurface, MoreFramesBringThePartsNearerToTheBallsSegments) {
  double before = 1e300;
  for (const int frames : {9, 17, 33}) {
    Random random(5);
    const TwoSweeps two = two_sweeps(random, 3.0, frames);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), {&locator, 1},
                                           {two.scan.sweeps, two.partition}, spaced(0.4));
    const double error = std::abs(*surface.volume_ml - kBall_ml);
    EXPECT_LT(error, 0.45 * before) << frames;
    before = error;
  }
}

TEST(PartitionSurface, WedgesBetweenTwoPlanesThatCrossAreSharesOfTheBall) {
  const Eigen::Vector3d centre(3.0, 4.0, 5.0);
  const double angle = 2.2;  // between the planes: wide, so that what lies opposite is nearer to the other sweeps
  const Eigen::Quaterniond turn(0.3, -0.2, 0.8, 0.4);
  const Eigen::Isometry3d place = Eigen::Translation3d(centre) * turn.normalized();
  const Scan scan({place.linear() * Eigen::Vector3d(0, 0, 1), place.linear() * Eigen::Vector3d(1, 1, 0).normalized(),
                   place.linear() * Eigen::Vector3d(0, 1, 1).normalized()},
                  41, centre);
  const auto across = [&](double at) {
    return Eigen::Vector3d(place.linear() * Eigen::Vector3d(std::cos(at), std::sin(at), 0.0));
  };
  const DividingPlane first(across(0.5 * kPi), centre);           // contains the direction at 0
  const DividingPlane second(across(angle + 0.5 * kPi), centre);  // contains the direction at `angle`
  // Sweeps in three of the four wedges; the fourth, opposite to the first, goes to either of its neighbours.
  const SpacePartition partition(
      {one_centre(centre + 40.0 * across(0.5 * angle)), one_centre(centre + 40.0 * across(angle + 0.5 * (kPi - angle))),
       one_centre(centre + 40.0 * across(-0.5 * (kPi - angle)))},
      {first, second});
  const FrameLocator locator = scan.locator();
  const auto surface = partition_surface(ball(locator, centre, kRadius), {&locator, 1}, {scan.sweeps, partition},
                                         spaced(0.5, GapOrder::kCurved));
  ASSERT_EQ(surface.parts.size(), 3u) << "two cells of one sweep are one part";
  double widest = 0.0;
  for (const PartSurface& part : surface.parts) {
    expect_closed(part.surface.mesh);
    const bool joined = part.planes.size() == 1;
    const double share = joined ? kPi : part.sweep == 0 ? angle : kPi - angle;
    EXPECT_NEAR(*part.volume_ml, kBall_ml * share / (2.0 * kPi), 0.005 * kBall_ml) << "sweep " << part.sweep;
    widest = std::max(widest, share);
  }
  EXPECT_EQ(widest, kPi);
  EXPECT_NEAR(*surface.volume_ml, kBall_ml, 0.006 * kBall_ml);
}

TEST(PartitionSurface, DoesNotDependOnWhereAllOfItLies) {
  Random random(9);
  const TwoSweeps two = two_sweeps(random, 2.0, 15);
  const FrameLocator locator = two.scan.locator();
  const Structure structure = ball(locator, two.scan.centre, kRadius);
  const auto here = partition_surface(structure, {&locator, 1}, {two.scan.sweeps, two.partition}, spaced(0.7));
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(300.0, -2000.0, 150.0) * Eigen::Quaterniond(0.3, 0.5, -0.7, 0.2).normalized();
  std::vector<Eigen::Isometry3d> poses = two.scan.poses;
  for (Eigen::Isometry3d& pose : poses) pose = motion * pose;
  DividingPlane plane = two.plane;
  plane = DividingPlane(motion.linear() * plane.normal(), motion * plane.projection(two.scan.centre));
  std::vector<SweepShape> shapes = two.partition.sweeps();
  for (SweepShape& shape : shapes) shape = one_centre(motion * shape.centres_mm[0]);
  const FrameLocator moved = scan_of(poses, 0.1);
  const auto there =
      partition_surface(structure, {&moved, 1}, {two.scan.sweeps, SpacePartition(shapes, {plane})}, spaced(0.7));
  ASSERT_EQ(there.parts.size(), here.parts.size());
  for (std::size_t i = 0; i < here.parts.size(); ++i) {
    EXPECT_NEAR(*there.parts[i].volume_ml, *here.parts[i].volume_ml, 1e-4 * kBall_ml);
  }
}

TEST(PartitionSurface, OpenPartsHaveAVolumeWhereNoMoreThanTwoPlanesCut) {
  const Eigen::Vector3d centre(0.0, 0.0, 0.0);
  const Scan scan({Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0.8, 0)}, 15, centre);
  const FrameLocator locator = scan.locator();
  const Structure structure = ball(locator, centre, kRadius);
  // One sweep in a corner of three planes, the other all around.
  std::vector<DividingPlane> planes;
  for (const std::size_t count : {1u, 2u, 3u}) {
    planes.emplace_back(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(count) - 1), 1.0);
    const SpacePartition partition({one_centre({30, 30, 30}), one_centre({-30, -30, -30})}, planes);
    const auto closed = partition_surface(structure, {&locator, 1}, {scan.sweeps, partition}, spaced(0.8));
    const auto open = partition_surface(structure, {&locator, 1}, {scan.sweeps, partition}, spaced(0.8), Caps::kOpen);
    ASSERT_EQ(open.parts.size(), closed.parts.size());
    bool any_refused = false;
    for (std::size_t i = 0; i < open.parts.size(); ++i) {
      ASSERT_TRUE(closed.parts[i].volume_ml.has_value());
      EXPECT_FALSE(mesh_topology(open.parts[i].surface.mesh).closed());
      if (open.parts[i].planes.size() > 2) {
        any_refused = true;
        EXPECT_FALSE(open.parts[i].volume_ml.has_value());
        EXPECT_NE(open.parts[i].no_volume.find("3 planes"), std::string::npos);
      } else {
        ASSERT_TRUE(open.parts[i].volume_ml.has_value());
        EXPECT_NEAR(*open.parts[i].volume_ml, *closed.parts[i].volume_ml, 1e-9);
      }
    }
    EXPECT_EQ(any_refused, count == 3);
    EXPECT_EQ(open.volume_ml.has_value(), count < 3);
  }
}

}  // namespace
}  // namespace fathom
