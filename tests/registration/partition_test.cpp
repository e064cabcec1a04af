#include "registration/partition.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/text_file.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

// Frames of 40 x 30 mm, advancing along z from `origin_mm`.
SweepShape box_sweep(const Eigen::Vector3d& origin_mm, int frames = 20, double step_mm = 1.0) {
  SweepShape shape;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d corner = origin_mm + Eigen::Vector3d(0, 0, i * step_mm);
    shape.centres_mm.push_back(corner + Eigen::Vector3d(20, 15, 0));
    shape.last_corners_mm = {corner, corner + Eigen::Vector3d(40, 0, 0), corner + Eigen::Vector3d(40, 30, 0),
                             corner + Eigen::Vector3d(0, 30, 0)};
    if (i == 0) shape.first_corners_mm = shape.last_corners_mm;
  }
  return shape;
}

DividingPlane random_plane(Random& random, double reach_mm) {
  const Eigen::Vector3d normal(random.normal(), random.normal(), random.normal());
  return {normal.normalized(), random.uniform(-reach_mm, reach_mm)};
}

TEST(DividingPlanes, LieMidwayBetweenTheFacingSidesOfTwoSweeps) {
  const DividingPlane plane = plane_between(box_sweep({0, 0, 0}), box_sweep({50, 0, 0}));
  EXPECT_TRUE(plane.normal().isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_NEAR(-plane.offset(), 45.0, 1e-9);
}

TEST(DividingPlanes, TheOuterOnesOfThreeSweepsInARowAreKeptAndTheThirdRemoved) {
  const SpacePartition partition =
      place_dividing_planes({box_sweep({0, 0, 0}), box_sweep({50, 0, 0}), box_sweep({100, 0, 0})}, nullptr);
  EXPECT_EQ(partition.planes().size(), 2u);
  EXPECT_EQ(partition.cells().size(), 3u);
  EXPECT_EQ(partition.sweep_at({0, 15, 10}), 0u);
  EXPECT_EQ(partition.sweep_at({70, 15, 10}), 1u);
  EXPECT_EQ(partition.sweep_at({900, 15, 10}), 2u);
}

TEST(DividingPlanes, ManySweepsInARowOrAGridEachHaveTheirPart) {
  for (const int columns : {12, 4}) {
    std::vector<SweepShape> sweeps;
    for (int i = 0; i < 12; ++i) sweeps.push_back(box_sweep({50.0 * (i % columns), 40.0 * (i / columns), 0}));
    const SpacePartition partition = place_dividing_planes(sweeps, nullptr);
    EXPECT_LE(partition.planes().size(), SpacePartition::kMaxPlanes);
    EXPECT_GE(partition.planes().size(), columns == 12 ? 11u : 5u);
    for (std::size_t i = 0; i < sweeps.size(); ++i) EXPECT_EQ(partition.sweep_at(sweeps[i].centre_mm()), i);
  }
}

TEST(DividingPlanes, SweepsOfOneFrameAndWithoutOverlapAreSeparated) {
  const SpacePartition partition = place_dividing_planes({box_sweep({0, 0, 0}, 1), box_sweep({0, 500, 0}, 1)}, nullptr);
  ASSERT_EQ(partition.planes().size(), 1u);
  EXPECT_EQ(partition.sweep_at({20, 15, 0}), 0u);
  EXPECT_EQ(partition.sweep_at({20, 515, 0}), 1u);
}

TEST(DividingPlanes, NoPlaneIsMadeUpBetweenSweepsWithTheSameCentre) {
  std::vector<std::string> warnings;
  const SpacePartition partition = place_dividing_planes({box_sweep({0, 0, 0}), box_sweep({0, 0, 0})}, &warnings);
  EXPECT_TRUE(partition.planes().empty());
  EXPECT_EQ(warnings.size(), 1u);
  EXPECT_FALSE(partition.sweep_at({20, 15, 0}));
}

TEST(SpacePartition, HoldsExactlyTheCellsOfPlanesInGeneralPosition) {
  Random random(3);
  SpacePartition partition({box_sweep({0, 0, 0}), box_sweep({50, 0, 0})});
  // n planes in general position make 1 + n + n (n - 1) / 2 + n (n - 1) (n - 2) / 6 cells.
  const std::size_t expected[] = {1, 2, 4, 8, 15, 26, 42};
  for (std::size_t n = 0; n < 7; ++n) {
    EXPECT_EQ(partition.cells().size(), expected[n]);
    for (const auto& cell : partition.cells()) EXPECT_EQ(partition.sides_at(cell.inside_mm), cell.sides);
    partition.add(random_plane(random, 10.0));
  }
}

TEST(SpacePartition, TakesThirtyTwoPlanesAndNoMore) {
  Random random(4);
  std::vector<DividingPlane> planes;
  for (int i = 0; i < 32; ++i) planes.push_back(random_plane(random, 30.0));
  SpacePartition partition({box_sweep({0, 0, 0}), box_sweep({50, 0, 0})}, planes);
  EXPECT_LE(partition.cells().size(), 5489u);
  EXPECT_GT(partition.cells().size(), 4000u);  // some meet beyond the reach
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d point(random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(-100, 100));
    const auto sides = partition.sides_at(point);
    EXPECT_TRUE(std::any_of(partition.cells().begin(), partition.cells().end(),
                            [&](const auto& cell) { return cell.sides == sides; }));
  }
  EXPECT_THROW(partition.add(planes.front()), Error);
  EXPECT_EQ(partition.planes().size(), 32u);
}

TEST(SpacePartition, FollowsItsPlanesAndIgnoresParallelCopiesAndPlanesThroughNothing) {
  const std::vector<SweepShape> sweeps{box_sweep({0, 0, 0}), box_sweep({50, 0, 0})};
  SpacePartition partition(sweeps, {DividingPlane(Eigen::Vector3d::UnitX(), -45.0)});
  EXPECT_EQ(partition.sweep_at({44, 0, 0}), 0u);
  partition.move(0, DividingPlane(Eigen::Vector3d::UnitX(), -43.0));
  EXPECT_EQ(partition.sweep_at({44, 0, 0}), 1u);
  partition.add(DividingPlane(Eigen::Vector3d::UnitX(), -43.0));
  partition.add(DividingPlane(Eigen::Vector3d::UnitY(), -1e5));
  EXPECT_EQ(partition.cells().size(), 2u);
  partition.remove_redundant();
  EXPECT_EQ(partition.planes().size(), 1u);
  partition.remove(0);
  EXPECT_FALSE(partition.sweep_at({44, 0, 0}));
}

TEST(SpacePartition, HatchesThePartOfAFrameBeyondThePlane) {
  const SpacePartition partition({box_sweep({0, 0, 0}), box_sweep({50, 0, 0})},
                                 {DividingPlane(Eigen::Vector3d::UnitX(), -30.5)});
  const auto regions = partition.hatched(0, Eigen::Affine3d::Identity(), 41, 31);
  ASSERT_EQ(regions.size(), 1u);
  for (const Eigen::Vector2d& corner : regions[0]) EXPECT_GE(corner.x(), 30.5 - 1e-12);
  EXPECT_EQ(partition.hatched(1, Eigen::Affine3d::Identity(), 41, 31).size(), 1u);
  EXPECT_EQ(partition.visible_disc(0).size(), 1u);
}

TEST(PlanesFile, ReadsBackWhatWasWritten) {
  const auto path = std::filesystem::temp_directory_path() / "fathom_planes_test.json";
  const DividingPlane plane(Eigen::Vector3d(1, 2, 2) / 3.0, -12.5);
  write_text_file(path, planes_json({{Sweep{0, 0, 9}, Sweep{0, 12, 20}}, {plane}}));
  const PlanesFile file = read_planes(path);
  ASSERT_EQ(file.planes.size(), 1u);
  EXPECT_TRUE(file.planes[0].isApprox(plane, 1e-12));
  EXPECT_EQ(file.sweeps.at(1).last, 20);
  for (const char* bad : {"{}", R"({"dividing_planes": [{"normal": [0, 0, 0], "offset_mm": 1}]})",
                          R"({"dividing_planes": [{"normal": [0, 0, 1], "offset_mm": 1e9}]})",
                          R"({"dividing_planes": [], "sweeps": [{"first": 3, "last": 2}]})",
                          R"({"dividing_planes": [], "sweeps": [{"first": 0, "last": 2}, {"first": 2, "last": 3}]})"}) {
    write_text_file(path, bad);
    EXPECT_THROW(read_planes(path), Error) << bad;
  }
  std::filesystem::remove(path);
}

TEST(FindSweeps, SeparatesAtInvalidMarksPausesAndJumpsOnly) {
  std::vector<std::vector<Eigen::Isometry3d>> poses(40, {Eigen::Isometry3d::Identity()});
  for (int i = 0; i < 40; ++i) {
    poses[static_cast<std::size_t>(i)][0].translation() = Eigen::Vector3d(0, 0, i + (i >= 30 ? 100 : 0));
  }
  auto recording = recording_of_poses({"ProbeToTracker"}, poses);
  auto& frames = recording->edit().frames;
  frames[5].poses[0]->status = "MISSING";  // one lost pose separates nothing
  frames[10].image_status = "INVALID";
  for (std::size_t i = 20; i < 40; ++i) *frames[i].time_s += 1.0;
  const auto ends = [&] {
    std::vector<std::pair<int, int>> found;
    for (const Sweep& s : find_sweeps(*recording, FrameLocator(*recording, Calibration{})))
      found.emplace_back(s.first, s.last);
    return found;
  };
  EXPECT_EQ(ends(), (std::vector<std::pair<int, int>>{{0, 9}, {11, 19}, {20, 29}, {30, 39}}));
  for (auto& frame : frames) frame.image_status = "INVALID";
  EXPECT_TRUE(ends().empty());
}

TEST(FindSweeps, CanBeSplitJoinedAndDropped) {
  std::vector<Sweep> sweeps{{0, 0, 9}, {0, 12, 20}};
  split_sweep(sweeps, 0, 4);
  EXPECT_EQ(sweeps.size(), 3u);
  EXPECT_EQ(sweeps[0].last, 3);
  join_sweeps(sweeps, 1);
  EXPECT_EQ(sweeps[1].first, 4);
  EXPECT_EQ(sweeps[1].last, 20);
  drop_sweep(sweeps, 0);
  EXPECT_EQ(sweeps.size(), 1u);
  EXPECT_THROW(split_sweep(sweeps, 0, 4), Error);
  EXPECT_THROW(join_sweeps(sweeps, 0), Error);
}

}  // namespace
}  // namespace fathom
