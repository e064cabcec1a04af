#include "registration/sweep_verdict.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "registration/find_sweeps.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr double kInterval_s = 0.02;

/// A sweep along z whose frame i lies at `z_mm[i]`; images of 101 x 51 pixels of 1 mm in the x-y plane.
struct Scan {
  explicit Scan(const std::vector<double>& z_mm) {
    header.width = 101;
    header.height = 51;
    header.pixel_type = CV_8UC1;
    header.transforms = {"ProbeToTracker"};
    for (std::size_t i = 0; i < z_mm.size(); ++i) {
      FrameHeader frame;
      frame.time_s = 100.0 + kInterval_s * static_cast<double>(i);
      Pose pose{Eigen::Matrix4d::Identity(), "OK"};
      pose.matrix(2, 3) = z_mm[i];
      frame.poses = {pose};
      header.frames.push_back(frame);
    }
  }

  SweepVerdict verdict(const VerdictOptions& options = {}) const {
    const MemoryRecording recording("sweep", header, std::vector<cv::Mat>(header.frames.size(), image));
    return judge_sweep(recording, calibrated ? &calibration : nullptr, {}, samples, options);
  }
  FrameHeader& frame(std::size_t i) { return header.frames.at(i); }

  RecordingHeader header;
  cv::Mat image = cv::Mat::zeros(51, 101, CV_8UC1);
  Calibration calibration;
  bool calibrated = true;
  std::vector<TrackerSample> samples;
};

std::vector<double> steady(int frames, double step_mm, double start_mm = 0.0) {
  std::vector<double> z_mm;
  for (int i = 0; i < frames; ++i) z_mm.push_back(start_mm + step_mm * i);
  return z_mm;
}

VerdictOptions box_of(double z0, double z1) {
  VerdictOptions options;
  options.region_mm = Eigen::AlignedBox3d(Eigen::Vector3d(10, 10, z0), Eigen::Vector3d(80, 40, z1));
  return options;
}

TEST(SweepVerdict, IsGoodForASteadySweepAndKnowsItsSpeed) {
  const SweepVerdict verdict = Scan(steady(100, 0.5)).verdict();
  EXPECT_TRUE(verdict.good()) << verdict.warnings.at(0);
  EXPECT_EQ(verdict.valid_frames, 100);
  EXPECT_NEAR(*verdict.largest_step_mm, 0.5, 1e-9);
  EXPECT_NEAR(*verdict.speed_mm_s, 25.0, 1e-6);
  EXPECT_FALSE(verdict.jitter);
  EXPECT_FALSE(verdict.passes_start);
}

TEST(SweepVerdict, FollowsTheImagesCornersWhereTheProbeTurns) {
  Scan scan(steady(20, 0.0));
  const double turn_rad = 0.05;
  for (std::size_t i = 0; i < 20; ++i) {
    const Eigen::AngleAxisd turn(turn_rad * static_cast<double>(i), Eigen::Vector3d::UnitY());
    scan.frame(i).poses[0]->matrix.topLeftCorner<3, 3>() = turn.toRotationMatrix();
  }
  const SweepVerdict verdict = scan.verdict();
  // The far corners are 100 mm from the axis.
  EXPECT_NEAR(*verdict.largest_step_mm, 2 * 100 * std::sin(turn_rad / 2), 1e-9);
  EXPECT_EQ(verdict.too_fast, 19);
  scan.calibrated = false;
  EXPECT_NEAR(*scan.verdict().largest_step_mm, 0.0, 1e-9);
}

TEST(SweepVerdict, CountsGapsDropoutsAndStepsThatAreTooLong) {
  std::vector<double> z_mm = steady(100, 0.5);
  for (std::size_t i = 60; i < 100; ++i) z_mm[i] += 3.0;
  Scan scan(z_mm);
  for (std::size_t i = 30; i < 100; ++i) *scan.frame(i).time_s += 0.2;
  for (std::size_t i = 40; i < 45; ++i) scan.frame(i).poses[0]->status = "OUT_OF_VIEW";
  scan.frame(99).image_status = "INVALID";
  const SweepVerdict verdict = scan.verdict();
  EXPECT_EQ(verdict.gaps, 1);
  EXPECT_NEAR(verdict.longest_gap_s, 0.22, 1e-9);
  EXPECT_EQ(verdict.dropouts, 2);
  EXPECT_NEAR(verdict.longest_dropout_s, 6 * kInterval_s, 1e-9);
  EXPECT_EQ(verdict.too_fast, 1);
  EXPECT_NEAR(*verdict.largest_step_mm, 3.5, 1e-9);
  EXPECT_EQ(verdict.valid_frames, 94);
  EXPECT_EQ(verdict.warnings.size(), 3u);
}

TEST(SweepVerdict, HasNoGapBetweenSweepsThatTheRecorderWasToldOf) {
  Scan scan(steady(40, 0.5));
  for (std::size_t i = 0; i < 40; ++i) {
    scan.frame(i).fields = {{"Sweep", i < 20 ? "0" : "1"}};
    *scan.frame(i).time_s += i < 20 ? 0.0 : 0.3;
  }
  EXPECT_TRUE(scan.verdict().good());
  const MemoryRecording recording("sweep", scan.header, std::vector<cv::Mat>(40, scan.image));
  const auto sweeps = find_sweeps(recording, FrameLocator(recording, scan.calibration));
  EXPECT_EQ(sweeps, (std::vector<Sweep>{{0, 0, 19}, {0, 20, 39}}));
}

TEST(SweepVerdict, TellsWhetherBothEndsOfTheRegionArePassed) {
  for (const double direction : {1.0, -1.0}) {
    const Scan scan(steady(81, 0.5 * direction, direction > 0 ? 0.0 : 40.0));  // from 0 to 40 mm, or back
    const SweepVerdict both = scan.verdict(box_of(5, 35));
    EXPECT_TRUE(*both.passes_start && *both.passes_end && both.good());
    const SweepVerdict late = scan.verdict(direction > 0 ? box_of(-5, 35) : box_of(5, 45));
    EXPECT_FALSE(*late.passes_start);
    EXPECT_TRUE(*late.passes_end);
    const SweepVerdict early = scan.verdict(direction > 0 ? box_of(5, 45) : box_of(-5, 35));
    EXPECT_TRUE(*early.passes_start);
    EXPECT_FALSE(*early.passes_end);
    EXPECT_EQ(early.warnings.size(), 1u);
  }
}

TEST(SweepVerdict, DoesNotUseACalibrationOfOtherImagesAndSaysSo) {
  Scan scan(steady(30, 0.5));
  scan.calibration.image_size = cv::Size(640, 480);
  const SweepVerdict verdict = scan.verdict(box_of(2, 3));
  EXPECT_FALSE(verdict.passes_start);
  ASSERT_EQ(verdict.warnings.size(), 1u);
  EXPECT_NE(verdict.warnings[0].find("another size"), std::string::npos);
  scan.header.transforms = {"StylusToTracker"};
  EXPECT_NE(scan.verdict().warnings.at(0).find("no transforms lead from the probe"), std::string::npos);
}

TEST(TrackerJitter, IsTheNoiseOfAProbeThatIsHeldStill) {
  Random random(3);
  const double sd_mm = 0.3;
  const double sd_rad = 0.004;
  const auto noisy = [&](double z_mm, double time_s) {
    Pose pose{Eigen::Matrix4d::Identity(), "OK"};
    const Eigen::Vector3d turn(sd_rad * random.normal(), sd_rad * random.normal(), sd_rad * random.normal());
    pose.matrix.topLeftCorner<3, 3>() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    for (int axis = 0; axis < 3; ++axis) pose.matrix(axis, 3) = sd_mm * random.normal();
    pose.matrix(2, 3) += z_mm;
    return TrackerSample{"ProbeToTracker", pose, time_s, time_s, {}};
  };
  std::vector<TrackerSample> samples;
  // Still for 10 s, a sweep of 4 s at 30 mm/s, lost for a while.
  for (int i = 0; i < 1000; ++i) samples.push_back(noisy(0.0, 0.01 * i));
  for (int i = 0; i < 400; ++i) samples.push_back(noisy(0.3 * i, 10.0 + 0.01 * i));
  for (int i = 0; i < 50; ++i) samples.push_back({"ProbeToTracker", {{}, "OUT_OF_VIEW"}, 14.0 + 0.01 * i, 0.0, {}});
  const auto jitter = tracker_jitter(samples);
  ASSERT_TRUE(jitter);
  // Of a thousand samples the rms is known to 2 %.
  EXPECT_NEAR(jitter->position_mm / (std::sqrt(3.0) * sd_mm), 1.0, 0.06);
  EXPECT_NEAR(jitter->angle_deg / (std::sqrt(3.0) * sd_rad * 180.0 / std::numbers::pi), 1.0, 0.06);
  EXPECT_NEAR(jitter->still_s, 9.5, 0.6);
  Scan scan(steady(30, 0.5));
  scan.samples = samples;
  EXPECT_NE(scan.verdict().warnings.at(0).find("the tracker is unsteady"), std::string::npos);
  EXPECT_FALSE(tracker_jitter(std::span(samples).subspan(1000)));
}

TEST(TrackerJitter, IsNotTheMotionOfASlowSweep) {
  std::vector<TrackerSample> samples;
  for (int i = 0; i < 400; ++i) {
    Pose pose{Eigen::Matrix4d::Identity(), "OK"};
    const double time_s = 0.01 * i;
    pose.matrix(2, 3) = i < 200 ? 5.0 * time_s : 10.0 + (time_s - 2.0);  // 5 mm/s, then the drift of a resting hand
    samples.push_back({"ProbeToTracker", pose, time_s, time_s, {}});
  }
  EXPECT_FALSE(tracker_jitter(std::span(samples).first(200)));
  ASSERT_TRUE(tracker_jitter(samples));
  EXPECT_LT(tracker_jitter(samples)->position_mm, 0.2);
}

TEST(VerdictOptions, RefusesWhatCannotBe) {
  VerdictOptions options;
  options.max_step_mm = 0.0;
  EXPECT_NE(message_of<Error>([&] { options.check(); }), "");
}

}  // namespace
}  // namespace fathom
