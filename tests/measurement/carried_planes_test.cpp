#include "measurement/carried_planes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "acquisition/recording.h"
#include "core/random.h"
#include "registration/frame_locator.h"

namespace fathom {
namespace {

Eigen::Vector3d random_vector(Random& random, double scale) {
  return scale * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
}

SectionPlane random_plane(Random& random) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
                                   .normalized()
                                   .toRotationMatrix();
  return {random_vector(random, 50.0), turn.col(0), turn.col(1)};
}

// A hand-held sweep: every frame moved and turned a little against the one before; the third has no pose.
MemoryRecording wandering_sweep(int frames) {
  Random random(5);
  RecordingHeader header;
  header.transforms = {"ProbeToTracker"};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(1000.0, -300.0, 40.0));
  for (int i = 0; i < frames; ++i) {
    pose.translate(Eigen::Vector3d(0.1, -0.05, 1.0) + random_vector(random, 0.05));
    pose.rotate(Eigen::AngleAxisd(0.02, Eigen::Vector3d(random.normal(), 1.0, 0.4).normalized()));
    FrameHeader frame;
    frame.poses.emplace_back(Pose{pose.matrix(), i == 2 ? "INVALID" : "OK"});
    header.frames.push_back(frame);
  }
  return MemoryRecording("sweep", header, {});
}

TEST(CarriedPlanes, LieOverEachOtherAlongTheAverageNormal) {
  Random random(11);
  int carried_count = 0;
  for (int i = 0; i < 200; ++i) {
    const SectionPlane from = random_plane(random);
    const SectionPlane to = random_plane(random);
    const auto carried = carried_to(from, to.origin_mm, to.normal());
    const bool opposite = from.normal().dot(to.normal()) < std::cos(kMaxCarryAngle_rad);
    ASSERT_EQ(carried.has_value(), !opposite);
    if (!carried) continue;
    ++carried_count;
    EXPECT_LT((carried->normal() - to.normal()).norm(), 1e-12);
    EXPECT_NEAR(carried->a_axis.dot(carried->b_axis), 0.0, 1e-12);
    const Eigen::Vector3d average = (from.normal() + to.normal()).normalized();
    const Eigen::Vector2d ab(random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0));
    const Eigen::Vector3d way = carried->at(ab) - from.at(ab);
    EXPECT_NEAR(way.cross(average).norm(), 0.0, 1e-9 * (1.0 + way.norm()));
    EXPECT_NEAR((carried->at(ab) - to.origin_mm).dot(to.normal()), 0.0, 1e-9 * (1.0 + way.norm()));
  }
  EXPECT_GT(carried_count, 150);
}

TEST(CarriedPlanes, PutEveryPixelWhereItsFrameIs) {
  const MemoryRecording sweep = wandering_sweep(12);
  Calibration calibration;
  calibration.probe_from_image.linear() = Eigen::DiagonalMatrix<double, 3>(0.2, 0.3, 0.25);
  calibration.probe_from_image.translation() = Eigen::Vector3d(-20.0, 5.0, 30.0);
  const FrameLocator locator(sweep, calibration);
  const auto planes = carried_planes(locator);
  ASSERT_EQ(planes.size(), 12u);
  EXPECT_FALSE(planes[2].has_value());
  for (std::size_t frame = 0; frame < planes.size(); ++frame) {
    if (frame == 2) continue;
    ASSERT_TRUE(planes[frame].has_value());
    const Eigen::Vector2d px(211.0, 34.5);
    const Eigen::Vector3d in_space =
        *locator.reference_from_image(static_cast<int>(frame)) * Eigen::Vector3d(px.x(), px.y(), 0.0);
    EXPECT_LT((planes[frame]->plane.at(planes[frame]->ab_from_image * px) - in_space).norm(), 1e-9);
  }
}

// Through a hundred small steps: what lies over each other stays so, though the direct way was never taken.
TEST(CarriedPlanes, KeepTheirPlaceThroughManyFrames) {
  const MemoryRecording sweep = wandering_sweep(100);
  const FrameLocator locator(sweep, Calibration{});
  const auto planes = carried_planes(locator);
  const SectionPlane& first = planes[20]->plane;
  const SectionPlane& last = planes[30]->plane;
  const auto direct = carried_to(first, last.origin_mm, last.normal());
  ASSERT_TRUE(direct.has_value());
  const Eigen::Vector2d near = planes[20]->ab_from_image * Eigen::Vector2d(30.0, 20.0);
  EXPECT_LT((direct->at(near) - last.at(near)).norm(), 0.05 * (last.at(near) - first.at(near)).norm());
}

}  // namespace
}  // namespace fathom
