#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "measurement/partition_volume.h"
#include "registration/dividing_planes.h"
#include "tests/measurement/sections.h"
#include "tests/measurement/sphere_scan.h"

// A ball scanned by two or three sweeps side by side, none of which sees all of it.
namespace fathom {
namespace {

constexpr double kRadius_mm = 25.0;
constexpr double kPixel_mm = 0.25;
constexpr int kWidth_px = 160;   // 40 mm: less than the ball
constexpr int kHeight_px = 240;  // 60 mm
constexpr int kFrames = 41;
const Eigen::Vector3d kCentre_mm(0.0, 30.0, 0.0);

struct SeveralSweeps {
  std::vector<FrameLocator> locators;
  std::vector<Sweep> sweeps;
  Structure structure;

  SpacePartition partition(std::vector<DividingPlane> planes) const {
    return SpacePartition(shapes(), std::move(planes));
  }
  SpacePartition placed() const { return place_dividing_planes(shapes(), nullptr); }
  std::vector<SweepShape> shapes() const {
    std::vector<SweepShape> made;
    for (const Sweep& sweep : sweeps)
      made.push_back(sweep_shape(sweep, locators[sweep.recording], kWidth_px, kHeight_px));
    return made;
  }
};

/// Sweeps along z with their middle at these x, tilted a little; each a recording of its own.
SeveralSweeps side_by_side(const std::vector<double>& middles_mm, double tilt_rad = 0.1,
                           const Eigen::Isometry3d& motion = Eigen::Isometry3d::Identity()) {
  SeveralSweeps made;
  for (std::size_t s = 0; s < middles_mm.size(); ++s) {
    std::vector<Eigen::Isometry3d> poses;
    const double tilt = s % 2 == 0 ? tilt_rad : -tilt_rad;
    for (const double z : evenly(-35.0, 35.0, kFrames)) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translate(Eigen::Vector3d(middles_mm[s], 0.0, s % 2 == 0 ? z : -z));
      pose.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()));
      pose.translate(Eigen::Vector3d(-0.5 * kPixel_mm * (kWidth_px - 1), 0.0, 0.0));
      poses.push_back(motion * pose);
    }
    made.locators.push_back(scan_of(poses, kPixel_mm));
    made.sweeps.push_back({s, 0, kFrames - 1});
    for (Contour contour : ball(made.locators.back(), motion * kCentre_mm, kRadius_mm, 2).contours) {
      contour.recording = static_cast<int>(s);
      made.structure.contours.push_back(contour);
    }
  }
  made.structure.name = "ball";
  return made;
}

std::vector<double> volumes(const PartitionedVolume& measured) {
  std::vector<double> values;
  for (const auto& value : {measured.total.linear_ml, measured.total.cubic_ml, measured.total.cubic_3d_ml}) {
    values.push_back(value.value_or(0.0));
  }
  return values;
}

TEST(SeveralSweeps, OfABallSumToItsVolume) {
  for (const auto& middles : {std::vector<double>{-15, 15}, std::vector<double>{-22, 0, 22}}) {
    const SeveralSweeps scan = side_by_side(middles);
    const SpacePartition partition = scan.placed();
    ASSERT_EQ(partition.planes().size(), middles.size() - 1);
    const auto measured = measure_partitions(scan.structure, scan.locators, scan.sweeps, partition);
    ASSERT_EQ(measured.partitions.size(), middles.size());
    double sum = 0.0;
    for (const PartitionVolume& part : measured.partitions) sum += part.measurement.volumes.cubic_ml.value();
    EXPECT_DOUBLE_EQ(measured.total.cubic_ml.value(), sum);
    for (const double volume : volumes(measured)) {
      EXPECT_NEAR(volume, sections::sphere_ml(kRadius_mm), 0.01 * sections::sphere_ml(kRadius_mm));
    }
  }
}

TEST(SeveralSweeps, MoveRigidlyWithTheirPlanes) {
  Random random(5);
  const auto still = side_by_side({-22, 0, 22});
  const SpacePartition partition = still.placed();
  const auto before = volumes(measure_partitions(still.structure, still.locators, still.sweeps, partition));
  for (int i = 0; i < 5; ++i) {
    const Eigen::Isometry3d motion = sections::random_motion(random, 1.0);
    const auto moved = side_by_side({-22, 0, 22}, 0.1, motion);
    std::vector<DividingPlane> planes = partition.planes();
    for (DividingPlane& plane : planes) plane.transform(Eigen::Affine3d(motion), Eigen::Isometry);
    // The outlines are drawn anew in pixels: take those of the scan that stood still.
    const auto after =
        volumes(measure_partitions(still.structure, moved.locators, moved.sweeps, moved.partition(planes)));
    for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(after[k], before[k], 1e-9 * before[k]);
  }
}

TEST(SeveralSweeps, AreNotChangedByAPlaneThatSeparatesNone) {
  const auto scan = side_by_side({-15, 15});
  const SpacePartition partition = scan.placed();
  std::vector<DividingPlane> planes = partition.planes();
  planes.emplace_back(planes.front().normal(), Eigen::Vector3d(-500, 0, 0));
  const SpacePartition more = scan.partition(planes);
  EXPECT_FALSE(more.separates(1));
  const auto before = volumes(measure_partitions(scan.structure, scan.locators, scan.sweeps, partition));
  const auto after = volumes(measure_partitions(scan.structure, scan.locators, scan.sweeps, more));
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(after[k], before[k], 1e-9 * before[k]);
}

TEST(SeveralSweeps, WithoutPlanesHaveAVolumeEachAndNoSum) {
  const auto scan = side_by_side({-15, 15});
  EXPECT_THROW(measure_partitions(scan.structure, scan.locators, scan.sweeps, scan.partition({})), Error);
  const auto measured = measure_sweeps(scan.structure, scan.locators, scan.sweeps);
  ASSERT_EQ(measured.partitions.size(), 2u);
  for (const PartitionVolume& part : measured.partitions) EXPECT_GT(part.measurement.volumes.cubic_ml.value(), 50.0);
  EXPECT_FALSE(measured.total.cubic_ml);
  ASSERT_FALSE(measured.warnings.empty());
  EXPECT_NE(measured.warnings.front().find("no sum"), std::string::npos);
}

TEST(SeveralSweeps, OutlinesThatNoSweepOrNoPartOfSpaceUsesAreNamed) {
  auto scan = side_by_side({-15, 15});
  // A plane far away: all of the ball is on one side, where one sweep is used.
  const auto far = measure_partitions(scan.structure, scan.locators, scan.sweeps,
                                      scan.partition({DividingPlane(Eigen::Vector3d::UnitZ(), -900.0)}));
  bool told = false;
  for (const std::string& warning : far.warnings) told = told || warning.find("not used") != std::string::npos;
  for (const auto& part : far.partitions) told = told || !part.loss.empty();
  EXPECT_TRUE(told);

  const auto partition = scan.placed();
  std::erase_if(scan.structure.contours, [](const Contour& contour) { return contour.recording == 1; });
  const auto half = measure_partitions(scan.structure, scan.locators, scan.sweeps, partition);
  EXPECT_FALSE(half.total.cubic_ml) << "half of the ball is not measured";
  ASSERT_FALSE(half.warnings.empty());
}

TEST(SeveralSweeps, ExtremitiesOfAnotherRecordingDoNotCount) {
  auto scan = side_by_side({-15, 15});
  scan.structure.extremities.push_back({0, {80, 120}, 1});
  EXPECT_EQ(section_outlines(scan.structure, scan.locators[0], scan.sweeps[0]).front().outlines.size(), 1u);
  EXPECT_TRUE(section_outlines(scan.structure, scan.locators[1], scan.sweeps[1]).front().outlines.empty());
}

TEST(SeveralSweeps, OutlinesWithBothEndsUnseenMayBeOpen) {
  auto scan = side_by_side({-15, 15}, 0.0);
  const auto partition = scan.partition({DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  const auto before = measure_partitions(scan.structure, scan.locators, scan.sweeps, partition);
  for (Contour& contour : scan.structure.contours) {
    // Circles begin at their largest x, which the sweep at x < 0 does not use: leave their first and last points out.
    if (contour.recording != 0) continue;
    const auto map = *scan.locators[0].reference_from_image(contour.frame);
    if ((map * Eigen::Vector3d(contour.points_px[5].x(), contour.points_px[5].y(), 0.0)).x() < 1.0) continue;
    contour.points_px.erase(contour.points_px.begin(), contour.points_px.begin() + 5);
    contour.points_px.resize(contour.points_px.size() - 4);
    contour.closed = false;
  }
  const auto after = measure_partitions(scan.structure, scan.locators, scan.sweeps, partition);
  EXPECT_NEAR(after.total.cubic_ml.value(), before.total.cubic_ml.value(), 1e-9 * before.total.cubic_ml.value());
  EXPECT_EQ(after.warnings.size(), before.warnings.size());

  // The other sweep is used at the ends of its own circles: closed, and told.
  for (Contour& contour : scan.structure.contours) contour.closed = contour.recording != 1;
  const auto told = measure_partitions(scan.structure, scan.locators, scan.sweeps, partition);
  EXPECT_GT(told.warnings.size(), after.warnings.size());
}

// Two sweeps along z, end to end, the first of which stops `gap_mm` before the plane z = 0; outlines beyond it or none.
double estimated_loss_ml(double gap_mm, bool beyond) {
  std::vector<Eigen::Isometry3d> poses;
  const auto shift = Eigen::Translation3d(-0.5 * kPixel_mm * kWidth_px, 0.0, 0.0);
  std::vector<double> places = evenly(-25.0, -gap_mm, 16);
  if (beyond) places.push_back(4.0);
  const int first_count = static_cast<int>(places.size());
  for (const double z : evenly(0.0, 25.0, 16)) places.push_back(z);
  for (const Eigen::Isometry3d& pose : turning_sweep(places)) poses.emplace_back(pose * shift);
  SeveralSweeps scan;
  scan.locators.push_back(scan_of(poses, kPixel_mm));
  scan.structure = ball(scan.locators[0], kCentre_mm, kRadius_mm);
  scan.sweeps = {{0, 0, first_count - 1}, {0, first_count, static_cast<int>(places.size()) - 1}};
  const auto measured = measure_partitions(scan.structure, scan.locators, scan.sweeps,
                                           scan.partition({DividingPlane(Eigen::Vector3d::UnitZ(), 0.0)}));
  double missing_ml = 0.0;
  for (const PartitionVolume& part : measured.partitions) {
    missing_ml += part.missing_ml;
    if (part.sweep != 0) continue;
    EXPECT_NEAR(part.gap_mm, gap_mm, 1e-6);
    EXPECT_NE(part.loss.find("short of the plane"), std::string::npos) << part.loss;
  }
  // What is measured and what is missing make the ball.
  EXPECT_NEAR(measured.total.cubic_ml.value() + missing_ml, sections::sphere_ml(kRadius_mm),
              0.01 * sections::sphere_ml(kRadius_mm));
  return missing_ml;
}

TEST(PartitionLoss, IsTheSliceThatIsMissingToFivePercent) {
  for (const double gap_mm : {1.0, 2.5, 5.0}) {
    const double slice_ml =
        std::numbers::pi * (kRadius_mm * kRadius_mm * gap_mm - gap_mm * gap_mm * gap_mm / 3.0) / 1000.0;
    for (const bool beyond : {false, true}) {
      EXPECT_NEAR(estimated_loss_ml(gap_mm, beyond), slice_ml, 0.05 * slice_ml) << gap_mm << " mm, " << beyond;
    }
  }
}

TEST(PartitionLoss, IsNoneWhereSectionsReachThePlaneOrTheStructureEndsBefore) {
  const auto scan = side_by_side({-15, 15}, 0.0);
  const auto partition = scan.partition({DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  for (const auto& part : measure_partitions(scan.structure, scan.locators, scan.sweeps, partition).partitions) {
    EXPECT_EQ(part.missing_ml, 0.0);
    EXPECT_TRUE(part.loss.empty());
  }
}

}  // namespace
}  // namespace fathom
