#include "measurement/partition_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "tests/measurement/sphere_scan.h"

namespace fathom {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 10.0;
constexpr double kBall_ml = 4.0 / 3.0 * kPi * kRadius * kRadius * kRadius / 1000.0;

ContourSurfaceOptions spaced(double spacing_mm, GapOrder order = GapOrder::kLinear) {
  ContourSurfaceOptions options;
  options.order = order;
  options.spacing_mm = spacing_mm;
  return options;
}

// Volume of the part of a ball that lies more than `height_mm` from its centre, on one side.
double segment_ml(double height_mm) {
  const double h = kRadius - height_mm;
  return kPi * h * h * (3.0 * kRadius - h) / 3.0 / 1000.0;
}

SweepShape one_centre(const Eigen::Vector3d& centre_mm) { return {{centre_mm}, {centre_mm}, {centre_mm}}; }

Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

// Sweeps over a ball about `centre`, one along every direction, each over all of it.
struct Scan {
  std::vector<Sweep> sweeps;
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  Scan(const std::vector<Eigen::Vector3d>& directions, int frames, const Eigen::Vector3d& ball_centre)
      : centre(ball_centre) {
    for (const Eigen::Vector3d& direction : directions) {
      const int first = static_cast<int>(poses.size());
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction);
      for (const double along : evenly(-kRadius, kRadius, frames)) {
        poses.emplace_back(Eigen::Translation3d(centre + 0.999 * along * direction) * turn);
      }
      sweeps.push_back({0, first, static_cast<int>(poses.size()) - 1});
    }
  }

  FrameLocator locator() const { return scan_of(poses, 0.1); }
};

void expect_closed(const Mesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold() && topology.oriented());
}

struct TwoSweeps {
  Scan scan;
  DividingPlane plane;
  SpacePartition partition;
};

// The plane lies `height` from the centre of the ball; sweep 0 is used on its positive side.
TwoSweeps two_sweeps(Random& random, double height, int frames = 41) {
  const Eigen::Vector3d centre(12.0, -5.0, 80.0);
  const Eigen::Vector3d normal = random_direction(random);
  Scan scan({random_direction(random), random_direction(random)}, frames, centre);
  const DividingPlane plane(normal, centre + height * normal);
  SpacePartition partition({one_centre(centre + 50.0 * normal), one_centre(centre - 50.0 * normal)}, {plane});
  return {scan, plane, partition};
}

TEST(PartitionSurface, PartsOfABallSeenByTwoSweepsAreItsSegments) {
  Random random(1);
  for (const double height : {-6.0, 0.0, 3.0, 7.0}) {
    SCOPED_TRACE(height);
    const TwoSweeps two = two_sweeps(random, height);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), locator, two.scan.sweeps,
                                           two.partition, spaced(0.5, GapOrder::kCurved));
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
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), locator, two.scan.sweeps,
                                           two.partition, spaced(0.5, GapOrder::kCurved));
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
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), locator, two.scan.sweeps,
                                           two.partition, spaced(0.4));
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
  const auto surface = partition_surface(ball(locator, centre, kRadius), locator, scan.sweeps, partition,
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
  const auto here = partition_surface(structure, locator, two.scan.sweeps, two.partition, spaced(0.7));
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(300.0, -2000.0, 150.0) * Eigen::Quaterniond(0.3, 0.5, -0.7, 0.2).normalized();
  std::vector<Eigen::Isometry3d> poses = two.scan.poses;
  for (Eigen::Isometry3d& pose : poses) pose = motion * pose;
  DividingPlane plane = two.plane;
  plane = DividingPlane(motion.linear() * plane.normal(), motion * plane.projection(two.scan.centre));
  std::vector<SweepShape> shapes = two.partition.sweeps();
  for (SweepShape& shape : shapes) shape = one_centre(motion * shape.centres_mm[0]);
  const auto there =
      partition_surface(structure, scan_of(poses, 0.1), two.scan.sweeps, SpacePartition(shapes, {plane}), spaced(0.7));
  ASSERT_EQ(there.parts.size(), here.parts.size());
  for (std::size_t i = 0; i < here.parts.size(); ++i) {
    EXPECT_NEAR(*there.parts[i].volume_ml, *here.parts[i].volume_ml, 1e-4 * kBall_ml);
  }
}

TEST(PartitionSurface, SweepsThatDisagreeAreSaidNotToMeet) {
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
  const auto surface = partition_surface(structure, locator, two.scan.sweeps, two.partition, spaced(0.5));
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

TEST(PartitionSurface, OpenContoursThatEndBeyondThePlaneChangeNothing) {
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
  const auto whole = partition_surface(closed, locator, two.scan.sweeps, two.partition, spaced(0.5));
  const auto part = partition_surface(open, locator, two.scan.sweeps, two.partition, spaced(0.5));
  EXPECT_NEAR(*part.volume_ml, *whole.volume_ml, 0.005 * kBall_ml);
  EXPECT_TRUE(part.warnings.empty());
}

TEST(PartitionSurface, AnOpenContourWhoseEndsAreJoinedInItsOwnPartIsSaid) {
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
  const auto surface = partition_surface(structure, locator, two.scan.sweeps, two.partition, spaced(1.0));
  ASSERT_FALSE(surface.warnings.empty());
  EXPECT_EQ(surface.warnings[0].find("frame " + std::to_string(contour.frame) + ": the open contour"), 0u)
      << surface.warnings[0];
}

TEST(PartitionSurface, ASweepThatWasNotOutlinedLeavesNoSum) {
  Random random(6);
  const TwoSweeps two = two_sweeps(random, 0.0, 15);
  const FrameLocator locator = two.scan.locator();
  Structure structure = ball(locator, two.scan.centre, kRadius);
  std::erase_if(structure.contours, [&](const Contour& c) { return c.frame >= two.scan.sweeps[1].first; });
  const auto surface = partition_surface(structure, locator, two.scan.sweeps, two.partition, spaced(1.0));
  ASSERT_EQ(surface.parts.size(), 1u);
  EXPECT_TRUE(surface.parts[0].volume_ml.has_value());
  EXPECT_FALSE(surface.volume_ml.has_value());
  ASSERT_FALSE(surface.warnings.empty());
  EXPECT_NE(surface.warnings.back().find("sweep 2"), std::string::npos) << surface.warnings.back();
  // One frame is worse than none.
  structure.contours.push_back(ball(locator, two.scan.centre, kRadius).contours.back());
  EXPECT_THROW(partition_surface(structure, locator, two.scan.sweeps, two.partition, spaced(1.0)), Error);
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
    const auto closed = partition_surface(structure, locator, scan.sweeps, partition, spaced(0.8));
    const auto open = partition_surface(structure, locator, scan.sweeps, partition, spaced(0.8), Caps::kOpen);
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

TEST(PartitionSurface, SweepsThatSeeOtherHalvesHaveNoSum) {
  // The first sweep sees what is left of a plane, the second what is right; the dividing plane stands across.
  const std::vector<double> places = evenly(-9.99, 9.99, 30);
  const FrameLocator locator = scan_of(turning_sweep(places), 0.1);
  const std::vector<Sweep> sweeps{{0, 0, 14}, {0, 15, 29}};
  const SpacePartition partition({one_centre({-30, 0, -5}), one_centre({30, 0, 5})},
                                 {DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  const auto surface =
      partition_surface(ball(locator, Eigen::Vector3d::Zero(), kRadius), locator, sweeps, partition, spaced(0.5));
  EXPECT_EQ(surface.parts.size(), 2u);
  EXPECT_FALSE(surface.volume_ml.has_value()) << "it would be half the ball";
  EXPECT_NE(surface.warnings.back().find("most of the cut at dividing plane 1"), std::string::npos);
}

TEST(PartitionSurface, PlanesThatGrazeTheBallSpoilNothing) {
  Random random(21);
  for (const double height : {9.6, 9.9, 9.99}) {
    const TwoSweeps two = two_sweeps(random, height);
    const FrameLocator locator = two.scan.locator();
    const auto surface = partition_surface(ball(locator, two.scan.centre, kRadius), locator, two.scan.sweeps,
                                           two.partition, spaced(0.5, GapOrder::kCurved));
    ASSERT_TRUE(surface.volume_ml.has_value()) << height;
    EXPECT_NEAR(*surface.volume_ml, kBall_ml, 0.006 * kBall_ml);
  }
}

TEST(PartitionSurface, OutlinesThatEndShortOfThePlaneAreSaidWithWhatIsMissing) {
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
  const auto surface =
      partition_surface(ball(locator, Eigen::Vector3d::Zero(), kRadius), locator, sweeps, partition, spaced(0.5));
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
}

TEST(PartitionSurface, SeveralSweepsWithoutPlanesAreRefused) {
  Random random(6);
  const TwoSweeps two = two_sweeps(random, 0.0, 9);
  const FrameLocator locator = two.scan.locator();
  EXPECT_THROW(partition_surface(ball(locator, two.scan.centre, kRadius), locator, two.scan.sweeps,
                                 SpacePartition(two.partition.sweeps()), {}),
               Error);
}

}  // namespace
}  // namespace fathom
