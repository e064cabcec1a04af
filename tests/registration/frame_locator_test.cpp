#include "registration/frame_locator.h"

#include <gtest/gtest.h>

#include "tests/registration/poses.h"

namespace fathom {
namespace {

Calibration turned_calibration() {
  Calibration calibration;
  calibration.probe_from_image.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix() *
      Eigen::Vector3d(0.1, 0.2, 0.15).asDiagonal();
  calibration.probe_from_image.translation() = Eigen::Vector3d(5, -3, 12);
  return calibration;
}

// A probe that moves at 50 mm/s and turns at 1 rad/s, about an axis of its own.
Eigen::Isometry3d moving_probe(double time_s) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(100, 20, -7) + 50.0 * time_s * Eigen::Vector3d(0.6, 0, 0.8);
  pose.linear() = Eigen::AngleAxisd(time_s, Eigen::Vector3d(0, 0.6, 0.8)).toRotationMatrix();
  return pose;
}

TEST(FrameLocator, MapsPixelsThroughCalibrationPoseAndReference) {
  Random random(11);
  const Calibration calibration = turned_calibration();
  const Eigen::Isometry3d probe = random_pose(random);
  const Eigen::Isometry3d reference = random_pose(random);
  const auto recording = recording_of_poses({"ReferenceToTracker", "ProbeToTracker"}, {{reference, probe}});
  const FrameLocator locator(*recording, calibration);
  const auto reference_from_image = locator.reference_from_image(0);
  ASSERT_TRUE(reference_from_image);
  const Eigen::Vector3d pixel(310, 77, 0);
  EXPECT_TRUE((*reference_from_image * pixel)
                  .isApprox(reference.inverse() * (probe * (calibration.probe_from_image * pixel)), 1e-12));
}

TEST(FrameLocator, PoseOfAFrameIsTheTrackersAtItsTimePlusLatency) {
  // The tracker's stamps lag by the latency: what it stored for time t is where the probe was at t - latency.
  const double latency_s = 0.1;
  std::vector<std::vector<Eigen::Isometry3d>> stored;
  for (int i = 0; i < 50; ++i) stored.push_back({moving_probe(0.04 * i - latency_s)});
  const auto recording = recording_of_poses({"ProbeToTracker"}, stored);
  Calibration calibration = turned_calibration();
  calibration.latency_s = latency_s;
  const FrameLocator locator(*recording, calibration);
  int located = 0;
  for (int i = 0; i < 50; ++i) {
    const auto found = locator.reference_from_image(i);
    if (!found) continue;
    ++located;
    const Eigen::Vector3d pixel(400, 300, 0);
    const Eigen::Vector3d truth = moving_probe(0.04 * i) * (calibration.probe_from_image * pixel);
    // Between samples 0.04 s apart a straight way cuts a circle by r (w dt)^2 / 8 = 0.03 mm at most.
    EXPECT_LT((*found * pixel - truth).norm(), 0.05) << "frame " << i;
  }
  EXPECT_EQ(located, 47);  // the last three frames look beyond the last pose
}

TEST(FrameLocator, LatencyNeverReachesOverLostPosesOrPauses) {
  std::vector<std::vector<Eigen::Isometry3d>> stored(10, {Eigen::Isometry3d::Identity()});
  auto recording = recording_of_poses({"ProbeToTracker"}, stored);
  recording->edit().frames[4].poses[0]->status = "MISSING";
  for (int i = 7; i < 10; ++i) *recording->edit().frames[static_cast<std::size_t>(i)].time_s += 2.0;
  Calibration calibration = turned_calibration();
  calibration.latency_s = 0.02;
  const FrameLocator locator(*recording, calibration);
  std::vector<int> lost;
  for (int i = 0; i < 10; ++i) {
    if (!locator.reference_from_image(i)) lost.push_back(i);
  }
  EXPECT_EQ(lost, (std::vector{3, 4, 6, 9}));
}

TEST(FrameLocator, LatencyNeedsTimeThatIncreases) {
  auto recording = recording_of_poses({"ProbeToTracker"}, std::vector(3, std::vector{Eigen::Isometry3d::Identity()}));
  Calibration calibration = turned_calibration();
  recording->edit().frames[2].time_s = recording->header().frames[1].time_s;
  EXPECT_NO_THROW(FrameLocator(*recording, calibration));
  calibration.latency_s = -0.05;
  EXPECT_THROW(FrameLocator(*recording, calibration), Error);
  recording->edit().frames[2].time_s.reset();
  EXPECT_THROW(FrameLocator(*recording, calibration), Error);
}

TEST(FrameLocator, RefusesACalibrationOfAnotherImageSize) {
  auto recording = recording_of_poses({"ProbeToTracker"}, {{Eigen::Isometry3d::Identity()}});
  recording->edit().width = 820;
  recording->edit().height = 616;
  Calibration calibration = turned_calibration();
  calibration.image_size = cv::Size(820, 616);
  EXPECT_NO_THROW(FrameLocator(*recording, calibration));
  calibration.image_size = cv::Size(616, 820);
  EXPECT_THROW(FrameLocator(*recording, calibration), Error);
}

TEST(FrameLocator, NamesOnTheCommandLineGoBeforeTheCalibrations) {
  Random random(5);
  const Eigen::Isometry3d probe = random_pose(random);
  const Eigen::Isometry3d stylus = random_pose(random);
  const auto recording = recording_of_poses({"ProbeToTracker", "StylusToTracker"}, {{probe, stylus}});
  Calibration calibration = turned_calibration();
  calibration.probe_frame = "Probe";
  const FrameLocator locator(*recording, calibration, {.probe = "Stylus", .reference = "Tracker"});
  EXPECT_EQ(locator.probe_frame(), "Stylus");
  EXPECT_TRUE(locator.reference_from_image(0)->isApprox(stylus * calibration.probe_from_image, 1e-9));
}

}  // namespace
}  // namespace fathom
