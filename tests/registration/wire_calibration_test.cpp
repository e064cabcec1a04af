#include "registration/wire_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "registration/pose_chain.h"
#include "registration/wire_phantom_file.h"
#include "tests/real_recordings.h"
#include "tests/registration/plus_result.h"
#include "tests/registration/poses.h"
#include "tests/registration/wire_scans.h"

namespace fathom {
namespace {

TEST(WireCalibration, FindsTheTruthOfPerfectPointsWithoutAGuess) {
  Random random(21);
  const WireScan made = scan_wires(random, 0.0, 0.0);
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
  EXPECT_LT(farthest_mm(fit.state, made.truth, 800, 600), 1e-4);
  EXPECT_EQ(fit.frames_used, 120);
  EXPECT_FALSE(fit.fitted[kPhantomTx]);
}

TEST(WireCalibration, EstimatesThePhantomsPoseWhereItIsNotKnown) {
  Random random(22);
  WireScan made = scan_wires(random, 0.0, 0.0);
  made.phantom.reference_from_phantom.reset();
  WireCalibrationOptions options;
  options.spatial.try_latency = false;
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom, options);
  EXPECT_LT(farthest_mm(fit.state, made.truth, 800, 600), 1e-3);
  EXPECT_TRUE(fit.state.reference_from_phantom.isApprox(made.truth.reference_from_phantom, 1e-5));
}

TEST(WireCalibration, FindsALatencyWithTheCalibration) {
  Random random(23);
  for (const double latency_s : {-0.42, 0.11}) {
    const WireScan made = scan_wires(random, 1.0, latency_s);
    const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
    EXPECT_NEAR(fit.state.latency_s, latency_s, 0.005);
    EXPECT_LT(farthest_mm(fit.state, made.truth, 800, 600), 0.3);
  }
}

TEST(WireCalibration, LatencyAndSkewThatAreNotThereAreNotFitted) {
  Random random(24);
  const WireScan made = scan_wires(random, 1.5, 0.0);
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
  EXPECT_EQ(fit.parameters.size(), 8u);
}

TEST(WireCalibration, AFifthOfTheFramesMayBeWrong) {
  Random random(25);
  const WireScan made = scan_wires(random, 1.0, 0.0);
  WireCalibrationOptions options;
  options.spatial.try_latency = false;
  const SpatialFit clean = calibrate_with_wires(made.tracked(), made.points, made.phantom, options);
  WireScan spoilt = made;
  for (std::size_t frame = 0; frame < spoilt.poses.size(); frame += 5) {
    spoilt.poses[frame]->translation() += Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * 15.0;
  }
  const SpatialFit fit = calibrate_with_wires(spoilt.tracked(), spoilt.points, spoilt.phantom, options);
  EXPECT_NEAR(fit.frames_used, 96, 3);
  for (Eigen::Index i = 0; i < 8; ++i) {
    EXPECT_LT(fit.covariance(i, i), 3.0 * clean.covariance(i, i));
  }
  EXPECT_LT(farthest_mm(fit.state, clean.state, 800, 600), 2.0 * clean.worst_point_sd_mm);
}

TEST(WireCalibration, ErrorsAreAsLargeAsTheCovarianceSays) {
  Random random(26);
  double squares = 0.0;
  int count = 0;
  WireCalibrationOptions options;
  options.spatial.try_latency = false;
  options.spatial.try_skew = false;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    const WireScan made = scan_wires(random, 1.5, 0.0);
    const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom, options);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double error = fit.state.translation_mm[i] - made.truth.translation_mm[i];
      squares += error * error / fit.covariance(i, i);
      ++count;
    }
  }
  // 120 normalised errors, those of a run not quite independent.
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.25);
}

TEST(WireCalibration, FaultsAreNamed) {
  Random random(27);
  const WireScan made = scan_wires(random, 0.5, 0.0);
  const auto complaint = [](const WireScan& s) {
    return message_of<Error>([&] { calibrate_with_wires(s.tracked(), s.points, s.phantom); });
  };
  EXPECT_EQ(complaint(made), "");
  WireScan few = made;
  std::erase_if(few.points, [](const WirePoint& point) { return point.frame > 2; });
  EXPECT_NE(complaint(few).find("in 3 frames only"), std::string::npos) << complaint(few);
  WireScan lost = made;
  for (std::size_t i = 5; i < lost.poses.size(); ++i) lost.poses[i].reset();
  EXPECT_NE(complaint(lost).find("in 5 frames only"), std::string::npos) << complaint(lost);
  WireScan still = made;
  still.phantom.reference_from_phantom.reset();
  for (auto& pose : still.poses) pose = made.poses[0];
  for (WirePoint& point : still.points) {
    point.position_px = made.points[static_cast<std::size_t>(point.pattern * 3 + point.wire)].position_px;
  }
  EXPECT_NE(complaint(still), "");
  WireScan wrong = made;
  std::swap(wrong.phantom.patterns[0], wrong.phantom.patterns[1]);
  for (NPattern& pattern : wrong.phantom.patterns) {
    for (Wire& wire : pattern) wire.front.z() = wire.back.z() = 1.7 * wire.front.z() + (wire.front.z() == 10 ? 9 : 0);
  }
  EXPECT_NE(complaint(wrong), "") << calibrate_with_wires(wrong.tracked(), wrong.points, wrong.phantom).rms_mm;
}

std::string complaint_about(const WireScan& scan, const WirePhantom& phantom) {
  WireCalibrationOptions options;
  options.spatial.try_latency = options.spatial.try_skew = false;
  return message_of<Error>([&] { calibrate_with_wires(scan.tracked(), scan.points, phantom, options); });
}

TEST(WireCalibration, AMovedPhantomIsTold) {
  Random random(28);
  const WireScan made = scan_wires(random, 0.5, 0.0);
  WirePhantom moved = made.phantom;
  moved.reference_from_phantom->translate(Eigen::Vector3d(60, 0, 0));
  const std::string complaint = complaint_about(made, moved);
  EXPECT_NE(complaint.find("but not in the place"), std::string::npos) << complaint;
  EXPECT_EQ(complaint.find("mirror"), std::string::npos) << complaint;
}

TEST(WireCalibration, AMirroredPhantomIsTold) {
  Random random(28);
  const WireScan made = scan_wires(random, 0.5, 0.0);
  WirePhantom mirrored = made.phantom;
  for (NPattern& pattern : mirrored.patterns) std::swap(pattern[1].front.y(), pattern[1].back.y());
  const std::string complaint = complaint_about(made, mirrored);
  EXPECT_NE(complaint.find("the mirror image"), std::string::npos) << complaint;
  EXPECT_EQ(complaint.find("not in the place"), std::string::npos) << complaint;
}

TEST(WireCalibration, RealSweepIsCalibratedBetterThanByPlus) {
  const std::filesystem::path data = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const WirePhantom phantom = read_wire_phantom(data / "PlusDeviceSet_fCal_Sim_SpatialCalibration_2.0.xml");
  const auto poses_of = [&](const char* name) {
    const auto recording = open_recording(data / name);
    return probe_poses(*recording, find_pose_chain(*recording, {}));
  };
  const std::filesystem::path result = data / "FreehandCalibration3NWires_fCal2.0.results.xml";
  const auto points = plus_points(result, "CalibrationData", phantom).second;
  const SpatialFit fit =
      calibrate_with_wires(poses_of("fCal_Test_Calibration_3NWires_fCal2.0.igs.mha"), points, phantom);
  const WireErrors errors = wire_errors(poses_of("fCal_Test_Validation_3NWires_fCal2.0.igs.mha"),
                                        plus_points(result, "ValidationData", phantom).second, phantom, fit.state);
  RecordProperty("validation_mean_mm", std::to_string(errors.mean_mm));
  EXPECT_LE(errors.mean_mm, 0.53);
  EXPECT_LE(errors.wire_mean_mm, 0.36);
  EXPECT_LE(errors.wire_rms_mm, 0.41);
}

}  // namespace
}  // namespace fathom
