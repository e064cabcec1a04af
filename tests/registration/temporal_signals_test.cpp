#include "registration/temporal_signals.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

Signal sampled(double noise, double hz, Random& random) {
  Signal signal{"test.mha", {}};
  for (double time = 0.0; time < 10.0; time += (0.8 + 0.4 * random.uniform()) / hz) {
    signal.values.push_back({time, 10.0 * std::sin(4.0 * time) + noise * random.normal()});
  }
  return signal;
}

TEST(SmoothSignal, FollowsASmoothMotionAndItsSpeed) {
  Random random(1);
  const SmoothSignal smooth(sampled(0.0, 40.0, random));
  for (double time = 0.5; time < 9.5; time += 0.0137) {
    const auto at = smooth.at(time);
    ASSERT_TRUE(at) << time;
    EXPECT_NEAR(at->value, 10.0 * std::sin(4.0 * time), 0.02);
    EXPECT_NEAR(at->slope, 40.0 * std::cos(4.0 * time), 1.5);
    EXPECT_NEAR(*smooth.roughly_at(time), 10.0 * std::sin(4.0 * time), 0.2);
  }
  EXPECT_FALSE(smooth.at(-0.1));
  EXPECT_FALSE(smooth.at(10.1));
}

TEST(SmoothSignal, KnowsItsNoise) {
  Random random(2);
  for (const double noise : {0.1, 0.7})
    EXPECT_NEAR(SmoothSignal(sampled(noise, 40.0, random)).noise(), noise, 0.1 * noise);
}

TEST(SmoothSignal, WeightsMakeTheValue) {
  Random random(3);
  const Signal signal = sampled(0.5, 30.0, random);
  const SmoothSignal smooth(signal);
  double value = 0.0;
  double sum = 0.0;
  for (const auto& [index, weight] : smooth.weights_at(4.321)) {
    value += weight * signal.values[index].value;
    sum += weight;
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_NEAR(value, smooth.at(4.321)->value, 1e-9);
}

TEST(SmoothSignal, DoesNotCrossGaps) {
  Random random(4);
  Signal signal = sampled(0.0, 40.0, random);
  std::erase_if(signal.values, [](const TimedValue& value) { return value.time_s > 4.0 && value.time_s < 4.4; });
  const SmoothSignal smooth(signal);
  EXPECT_FALSE(smooth.at(4.2));
  EXPECT_FALSE(smooth.roughly_at(4.2));
  EXPECT_TRUE(smooth.at(5.0));
}

TEST(MotionSignal, IsThePlaceAlongTheMainLineOfMotion) {
  Random random(5);
  const Eigen::Vector3d line = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  std::vector<std::vector<Eigen::Isometry3d>> rows;
  for (int i = 0; i < 100; ++i) {
    Eigen::Isometry3d pose = random_pose(random);
    pose.translation() = Eigen::Vector3d(500, 20, -300) + 15.0 * std::sin(0.2 * i) * line +
                         0.1 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    rows.push_back({pose});
  }
  auto recording = recording_of_poses({"ProbeToTracker"}, rows);
  const Signal signal = motion_signal(probe_poses(*recording, find_pose_chain(*recording, {})));
  ASSERT_EQ(signal.values.size(), 100u);
  const double sign = signal.values[8].value > signal.values[0].value ? 1.0 : -1.0;
  for (int i = 1; i < 100; ++i) {
    const double moved = sign * (signal.values[static_cast<std::size_t>(i)].value - signal.values[0].value);
    EXPECT_NEAR(moved, 15.0 * std::sin(0.2 * i), 0.8);
  }
  recording->edit().frames[7].time_s.reset();
  EXPECT_THROW(motion_signal(probe_poses(*recording, find_pose_chain(*recording, {}))), Error);
}

TEST(FloorSignal, IsTheDepthAtTheMiddleColumnOfFramesWithTime) {
  RecordingHeader header;
  header.width = 101;
  header.height = 100;
  header.frames.resize(4);
  header.frames[0].time_s = 1.0;
  header.frames[2].time_s = 1.5;
  header.frames[3].time_s = 1.5;
  std::vector<cv::Mat> images(4, cv::Mat::zeros(100, 101, CV_8UC1));
  const MemoryRecording recording("test.mha", header, images);
  std::vector<WallLine> walls;
  for (int frame = 0; frame < 4; ++frame) {
    WallLine wall;
    wall.frame = frame;
    wall.point_px = {20.0, 40.0 + frame};
    wall.direction = Eigen::Vector2d(4.0, 1.0).normalized();  // the middle is 30 pixels on, 7.5 deeper
    walls.push_back(wall);
  }
  const Signal signal = floor_signal(recording, walls);
  ASSERT_EQ(signal.values.size(), 2u);
  EXPECT_NEAR(signal.values[0].value, 47.5, 1e-9);
  EXPECT_EQ(signal.values[1].time_s, 1.5);
  EXPECT_NEAR(signal.values[1].value, 49.5, 1e-9);
  EXPECT_THROW(floor_signal(recording, {walls[1]}), Error);
}

}  // namespace
}  // namespace fathom
