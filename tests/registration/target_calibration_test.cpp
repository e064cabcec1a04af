#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "registration/point_calibration.h"
#include "registration/wall_calibration.h"
#include "tests/registration/target_scans.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

struct Target {
  const char* name;
  bool wall;
};
void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

SpatialFit calibrated(const TargetScan& scan, bool wall, const SpatialOptions& options) {
  return wall ? calibrate_with_wall(scan.tracked(), scan.lines, options)
              : calibrate_with_point(scan.tracked(), scan.points, options);
}

class TargetCalibration : public testing::TestWithParam<Target> {
 protected:
  bool wall() const { return GetParam().wall; }
  SpatialOptions plain() const {
    SpatialOptions options = wall() ? wall_options() : point_options();
    options.try_latency = options.try_skew = false;
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, TargetCalibration, testing::Values(Target{"Wall", true}, Target{"Point", false}),
                         [](const auto& target) { return std::string(target.param.name); });

TEST_P(TargetCalibration, FindsTheTruthOfPerfectDataWithoutAGuess) {
  Random random(31);
  for (int run = 0; run < 3; ++run) {
    TargetScanning how;
    how.noise_px = 0.0;
    const TargetScan scan = scan_target(how, wall(), random);
    const SpatialFit fit = calibrated(scan, wall(), plain());
    EXPECT_LT(farthest_mm(fit.state, scan.truth, kScanWidth_px, kScanHeight_px), 1e-3);
    EXPECT_EQ(fit.frames_used, how.frames);
  }
}

TEST_P(TargetCalibration, FindsALatencyWithTheCalibration) {
  Random random(32);
  for (const double latency_s : {-0.23, 0.08}) {
    TargetScanning how;
    how.latency_s = latency_s;
    const TargetScan scan = scan_target(how, wall(), random);
    SpatialOptions options = plain();
    options.try_latency = true;
    const SpatialFit fit = calibrated(scan, wall(), options);
    EXPECT_NEAR(fit.state.latency_s, latency_s, 0.005);
  }
}

TEST_P(TargetCalibration, MotionThatIsMissingIsNamed) {
  Random random(33);
  const auto complaint = [&](const TargetScanning& how) {
    const TargetScan scan = scan_target(how, wall(), random);
    return message_of<Error>([&] { calibrated(scan, wall(), plain()); });
  };
  EXPECT_EQ(complaint({}), "");
  TargetScanning flat;
  flat.tilt_rad = 0.002;
  EXPECT_NE(complaint(flat).find("tilt the probe"), std::string::npos) << complaint(flat);
  TargetScanning still = flat;
  still.twist_rad = 0.0;
  if (wall()) {
    still.tilt_rad = 0.03;
    EXPECT_NE(complaint(still).find("twist the probe"), std::string::npos) << complaint(still);
    TargetScanning level;
    level.height_mm = 0.1;
    level.tilt_rad = 0.02;
    EXPECT_NE(complaint(level).find("nearer to the floor"), std::string::npos) << complaint(level);
  }
}

TEST_P(TargetCalibration, FaultsAreNamed) {
  Random random(34);
  const TargetScan made = scan_target({}, wall(), random);
  const auto complaint = [&](const TargetScan& scan) {
    return message_of<Error>([&] { calibrated(scan, wall(), plain()); });
  };
  TargetScan few = made;
  few.lines.resize(std::min<std::size_t>(3, few.lines.size()));
  few.points.resize(std::min<std::size_t>(3, few.points.size()));
  EXPECT_NE(complaint(few).find("in 3 frames only"), std::string::npos) << complaint(few);
  TargetScan lost = made;
  for (std::size_t i = 30; i < 90; ++i) lost.poses[i].reset();
  EXPECT_NE(complaint(lost).find("only 60 of the 120 frames"), std::string::npos) << complaint(lost);
  TargetScan still = made;
  for (auto& pose : still.poses) pose = made.poses[0];
  EXPECT_NE(complaint(still).find("did not move"), std::string::npos) << complaint(still);
  TargetScan metres = made;
  for (auto& pose : metres.poses) pose->translation() *= 0.001;
  EXPECT_NE(complaint(metres).find("in metres"), std::string::npos) << complaint(metres);
  TargetScan loose = made;  // a target that is carried along
  for (auto& pose : loose.poses)
    pose->translation() += 10.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  EXPECT_NE(complaint(loose), "");
}

}  // namespace
}  // namespace fathom
