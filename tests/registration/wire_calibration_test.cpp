#include "registration/wire_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "registration/pose_chain.h"
#include "registration/wire_phantom_file.h"
#include "tests/real_recordings.h"
#include "tests/registration/plus_result.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

struct Scan {
  WirePhantom phantom;
  SpatialState truth;
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times_s;
  std::vector<WirePoint> points;

  ProbePoses tracked() const { return {"scan.mha", poses, times_s}; }
};

WirePhantom three_ns() {
  WirePhantom phantom;
  const auto add = [&phantom](double z, double front, double back) {
    const std::string n = std::to_string(phantom.patterns.size());
    phantom.patterns.push_back({Wire{n + "a", {0, 0, z}, {0, 40, z}}, Wire{n + "b", {front, 0, z}, {back, 40, z}},
                                Wire{n + "c", {30, 0, z}, {30, 40, z}}});
  };
  add(20, 27, 3);
  add(10, 3, 27);
  add(0, 24, 6);
  return phantom;
}

// A probe that sways over the phantom and turns about all axes; the tracker's stamps lag by `latency_s`.
Scan scan(Random& random, double noise_px, double latency_s) {
  Scan scan;
  scan.phantom = three_ns();
  scan.phantom.reference_from_phantom = random_pose(random);
  scan.truth.translation_mm = Eigen::Vector3d(12, -45, 8);
  scan.truth.rotation = Eigen::AngleAxisd(1.7, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
  scan.truth.log_sx = std::log(0.08);
  scan.truth.log_sy = std::log(0.074);
  scan.truth.latency_s = latency_s;
  scan.truth.reference_from_phantom = *scan.phantom.reference_from_phantom;
  // Rough: the image's x runs along the phantom's, its y down, so that its normal is along the wires.
  Eigen::Matrix3d upright;
  upright << Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY();
  Eigen::Isometry3d probe_from_image = Eigen::Isometry3d::Identity();
  probe_from_image.linear() = scan.truth.rotation.toRotationMatrix();
  probe_from_image.translation() = scan.truth.translation_mm;
  const auto reference_from_probe = [&](double t) {
    Eigen::Isometry3d phantom_from_image = Eigen::Isometry3d::Identity();
    phantom_from_image.linear() = upright * (Eigen::AngleAxisd(0.25 * std::sin(0.9 * t), Eigen::Vector3d::UnitX()) *
                                             Eigen::AngleAxisd(0.25 * std::sin(1.3 * t + 1), Eigen::Vector3d::UnitY()) *
                                             Eigen::AngleAxisd(0.25 * std::sin(1.1 * t + 2), Eigen::Vector3d::UnitZ()))
                                                .toRotationMatrix();
    phantom_from_image.translation() =
        Eigen::Vector3d(15, 20 + 8 * std::sin(2.0 * t), 30) - phantom_from_image.linear() * Eigen::Vector3d(32, 2, 0);
    return Eigen::Isometry3d(*scan.phantom.reference_from_phantom * phantom_from_image * probe_from_image.inverse());
  };
  constexpr int kFrames = 120;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double t = 0.05 * frame;
    scan.times_s.push_back(100.0 + t);
    scan.poses.push_back(reference_from_probe(t - latency_s));
    const Eigen::Isometry3d image_from_phantom =
        (scan.phantom.reference_from_phantom->inverse() * reference_from_probe(t) * probe_from_image).inverse();
    for (std::size_t p = 0; p < scan.phantom.patterns.size(); ++p) {
      for (std::size_t w = 0; w < 3; ++w) {
        const Eigen::Vector3d a = image_from_phantom * scan.phantom.patterns[p][w].front;
        const Eigen::Vector3d b = image_from_phantom * scan.phantom.patterns[p][w].back;
        const Eigen::Vector3d cut = a + (b - a) * a.z() / (a.z() - b.z());
        scan.points.push_back({frame, p, w,
                               Eigen::Vector2d(cut.x() / 0.08 + noise_px * random.normal(),
                                               cut.y() / 0.074 + noise_px * random.normal())});
      }
    }
  }
  return scan;
}

double farthest_mm(const SpatialState& a, const SpatialState& b) {
  double farthest = 0.0;
  for (const auto& pixel : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(800, 0, 0), Eigen::Vector3d(0, 600, 0),
                            Eigen::Vector3d(800, 600, 0)}) {
    farthest = std::max(farthest, (a.probe_from_image() * pixel - b.probe_from_image() * pixel).norm());
  }
  return farthest;
}

TEST(WireCalibration, FindsTheTruthOfPerfectPointsWithoutAGuess) {
  Random random(21);
  const Scan made = scan(random, 0.0, 0.0);
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
  EXPECT_LT(farthest_mm(fit.state, made.truth), 1e-4);
  EXPECT_EQ(fit.frames_used, 120);
  EXPECT_FALSE(fit.fitted[kPhantomTx]);
}

TEST(WireCalibration, EstimatesThePhantomsPoseWhereItIsNotKnown) {
  Random random(22);
  Scan made = scan(random, 0.0, 0.0);
  made.phantom.reference_from_phantom.reset();
  WireCalibrationOptions options;
  options.spatial.try_latency = false;
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom, options);
  EXPECT_LT(farthest_mm(fit.state, made.truth), 1e-3);
  EXPECT_TRUE(fit.state.reference_from_phantom.isApprox(made.truth.reference_from_phantom, 1e-5));
}

TEST(WireCalibration, FindsALatencyWithTheCalibration) {
  Random random(23);
  for (const double latency_s : {-0.42, 0.11}) {
    const Scan made = scan(random, 1.0, latency_s);
    const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
    EXPECT_NEAR(fit.state.latency_s, latency_s, 0.005);
    EXPECT_LT(farthest_mm(fit.state, made.truth), 0.3);
  }
}

TEST(WireCalibration, LatencyAndSkewThatAreNotThereAreNotFitted) {
  Random random(24);
  const Scan made = scan(random, 1.5, 0.0);
  const SpatialFit fit = calibrate_with_wires(made.tracked(), made.points, made.phantom);
  EXPECT_EQ(fit.parameters.size(), 8u);
}

TEST(WireCalibration, AFifthOfTheFramesMayBeWrong) {
  Random random(25);
  const Scan made = scan(random, 1.0, 0.0);
  WireCalibrationOptions options;
  options.spatial.try_latency = false;
  const SpatialFit clean = calibrate_with_wires(made.tracked(), made.points, made.phantom, options);
  Scan spoilt = made;
  for (std::size_t frame = 0; frame < spoilt.poses.size(); frame += 5) {
    spoilt.poses[frame]->translation() += Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * 15.0;
  }
  const SpatialFit fit = calibrate_with_wires(spoilt.tracked(), spoilt.points, spoilt.phantom, options);
  EXPECT_NEAR(fit.frames_used, 96, 3);
  for (Eigen::Index i = 0; i < 8; ++i) {
    EXPECT_LT(fit.covariance(i, i), 3.0 * clean.covariance(i, i));
  }
  EXPECT_LT(farthest_mm(fit.state, clean.state), 2.0 * clean.worst_point_sd_mm);
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
    const Scan made = scan(random, 1.5, 0.0);
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
  const Scan made = scan(random, 0.5, 0.0);
  const auto complaint = [](const Scan& s) {
    return message_of<Error>([&] { calibrate_with_wires(s.tracked(), s.points, s.phantom); });
  };
  EXPECT_EQ(complaint(made), "");
  Scan few = made;
  std::erase_if(few.points, [](const WirePoint& point) { return point.frame > 2; });
  EXPECT_NE(complaint(few).find("in 3 frames only"), std::string::npos) << complaint(few);
  Scan lost = made;
  for (std::size_t i = 5; i < lost.poses.size(); ++i) lost.poses[i].reset();
  EXPECT_NE(complaint(lost).find("in 5 frames only"), std::string::npos) << complaint(lost);
  Scan still = made;
  still.phantom.reference_from_phantom.reset();
  for (auto& pose : still.poses) pose = made.poses[0];
  for (WirePoint& point : still.points) {
    point.position_px = made.points[static_cast<std::size_t>(point.pattern * 3 + point.wire)].position_px;
  }
  EXPECT_NE(complaint(still), "");
  Scan wrong = made;
  std::swap(wrong.phantom.patterns[0], wrong.phantom.patterns[1]);
  for (NPattern& pattern : wrong.phantom.patterns) {
    for (Wire& wire : pattern) wire.front.z() = wire.back.z() = 1.7 * wire.front.z() + (wire.front.z() == 10 ? 9 : 0);
  }
  EXPECT_NE(complaint(wrong), "") << calibrate_with_wires(wrong.tracked(), wrong.points, wrong.phantom).rms_mm;
}

TEST(WireCalibration, RealSweepIsCalibratedBetterThanByPlus) {
  const std::filesystem::path data = real_recordings();
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "the real recordings are not beside the project";
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
