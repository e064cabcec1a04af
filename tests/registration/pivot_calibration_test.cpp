#include "registration/pivot_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/registration/coverage.h"
#include "tests/registration/pivoting.h"

namespace fathom {
namespace {

PivotCalibration calibrated(std::vector<std::optional<Eigen::Isometry3d>> poses) {
  return calibrate_pivot(ProbePoses("test.mha", std::move(poses), {}));
}

std::string refusal(std::vector<std::optional<Eigen::Isometry3d>> poses) {
  try {
    calibrated(std::move(poses));
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PivotCalibration, IsExactOnExactPoses) {
  Random random(1);
  auto poses = pivoting(150, 0.5, 0.4, 0.2, 0.0, 0.0, random);
  poses[3].reset();
  const PivotCalibration result = calibrated(poses);
  EXPECT_LT((result.tip_in_tool_mm - kTip).norm(), 1e-8);
  EXPECT_LT((result.pivot_in_reference_mm - kPivot).norm(), 1e-8);
  EXPECT_LT(result.rms_mm, 1e-8);
  EXPECT_EQ(result.poses_valid, 149);
  EXPECT_EQ(result.poses_used, 149);
}

// `kind(poses, random)` disturbs the poses of each of 400 runs.
template <typename Kind>
Coverage coverage(double noise_mm, double noise_rad, const Kind& kind) {
  Coverage result;
  Random random(5);
  for (int run = 0; run < 400; ++run) {
    auto poses = pivoting(150, 0.5, 0.35, 0.3, noise_mm, noise_rad, random);
    kind(poses, random);
    const PivotCalibration fit = calibrated(std::move(poses));
    Eigen::VectorXd errors(6);
    errors << fit.tip_in_tool_mm - kTip, fit.pivot_in_reference_mm - kPivot;
    result.add(errors, fit.covariance.diagonal().cwiseSqrt());
  }
  return result;
}

TEST(PivotCalibration, StandardDeviationsCoverNoiseOfPositions) {
  expect_covered(coverage(0.4, 0.0, [](auto&, Random&) {}));
}

TEST(PivotCalibration, StandardDeviationsCoverNoiseOfTurnsAndPositions) {
  expect_covered(coverage(0.1, 0.005, [](auto&, Random&) {}));
}

TEST(PivotCalibration, StandardDeviationsCoverPosesOfWhichAFifthIsWrong) {
  expect_covered(coverage(0.3, 0.002, [](auto& poses, Random& random) {
    for (auto& pose : poses) {
      if (random.uniform() < 0.2) pose->translation() += 30.0 * normal3(random);
    }
  }));
}

TEST(PivotCalibration, RepeatedPosesDoNotCountAsMore) {
  Random random(8);
  const auto poses = pivoting(150, 0.5, 0.35, 0.3, 0.3, 0.0, random);
  std::vector<std::optional<Eigen::Isometry3d>> repeated;
  for (const auto& pose : poses) repeated.insert(repeated.end(), 4, pose);
  const double once = calibrated(poses).tip_sd_mm().norm();
  EXPECT_NEAR(calibrated(repeated).tip_sd_mm().norm(), once, 0.15 * once);
}

TEST(PivotCalibration, ATipThatLeavesItsPlaceForATimeDoesNotPullIt) {
  Random random(9);
  auto poses = pivoting(300, 0.5, 0.35, 0.3, 0.3, 0.0, random);
  for (std::size_t i = 190; i < 300; ++i) poses[i]->translation() += Eigen::Vector3d(0.0, 0.0, 60.0);
  const PivotCalibration result = calibrated(poses);
  EXPECT_LT((result.tip_in_tool_mm - kTip).norm(), 0.3);
  EXPECT_NEAR(result.poses_used, 190, 3);
}

TEST(PivotCalibration, MotionsToOneSideStillDo) {
  Random random(10);
  auto poses = pivoting(400, 0.6, 0.5, 0.0, 0.2, 0.0, random);
  std::vector<std::optional<Eigen::Isometry3d>> one_side;
  const Eigen::Vector3d shaft = turn({0.4, -2.1, 0.7}) * kTip;
  const Eigen::Vector3d side = shaft.cross(Eigen::Vector3d::UnitX());
  for (const auto& pose : poses) {
    if (side.dot(pose->linear() * kTip) > 0.0) one_side.push_back(pose);
  }
  ASSERT_GT(one_side.size(), 100u);
  const PivotCalibration result = calibrated(one_side);
  EXPECT_LT((result.tip_in_tool_mm - kTip).norm(), 4.0 * result.tip_sd_mm().norm());
  EXPECT_LT(result.tip_sd_mm().norm(), 0.3);
}

TEST(PivotCalibration, SaysWhichMotionIsMissing) {
  Random random(11);
  EXPECT_NE(refusal(pivoting(100, 0.0, 0.0, 0.0, 0.3, 0.002, random)).find("hardly turned"), std::string::npos);
  const std::string one_axis = refusal(pivoting(100, 0.5, 0.0, 0.0, 0.3, 0.002, random));
  EXPECT_NE(one_axis.find("one axis only"), std::string::npos) << one_axis;
  EXPECT_NE(one_axis.find("(1.00, 0.0"), std::string::npos) << one_axis;
  EXPECT_NE(refusal(pivoting(10, 0.5, 0.5, 0.0, 0.3, 0.0, random)).find("10 valid poses"), std::string::npos);
}

TEST(PivotCalibration, AWavedToolHasNoTip) {
  Random random(12);
  auto poses = pivoting(200, 0.5, 0.4, 0.2, 0.0, 0.0, random);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i]->translation() += 100.0 * Eigen::Vector3d(std::sin(0.02 * static_cast<double>(i * i % 311)),
                                                       std::cos(0.7 * static_cast<double>(i)), 0.3);
  }
  EXPECT_NE(refusal(poses).find("agree on no tip"), std::string::npos) << refusal(poses);
}

}  // namespace
}  // namespace fathom
