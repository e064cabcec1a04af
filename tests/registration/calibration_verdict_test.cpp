#include "registration/calibration_verdict.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

struct Judged {
  SpatialFit fit;
  std::optional<ScanErrors> validation;
  CalibrationTarget target = CalibrationTarget::kWall;
  CalibrationScan scan{
      ProbePoses("test.mha",
                 std::vector<std::optional<Eigen::Isometry3d>>(100, std::optional(Eigen::Isometry3d::Identity())), {}),
      {640, 480}};

  Judged() {
    fit.frames_seen = 100;
    fit.frames_used = 98;
    fit.rms_mm = 0.4;
    fit.worst_point_sd_mm = 0.1;
  }
  CalibrationVerdict verdict() const { return verdict_on(fit, scan, target, validation); }
};

TEST(CalibrationVerdict, AGoodCalibrationIsCalledGoodAndNothingElse) { EXPECT_EQ(Judged().verdict().text, "good"); }

TEST(CalibrationVerdict, TheWorstCountsAndEveryFaultIsNamed) {
  Judged judged;
  judged.fit.worst_point_sd_mm = 0.5;
  EXPECT_EQ(judged.verdict().grade, CalibrationGrade::kUsable);
  judged.validation.emplace();
  judged.validation->mean_mm = 3.0;
  const CalibrationVerdict verdict = judged.verdict();
  EXPECT_EQ(verdict.grade, CalibrationGrade::kDoAgain);
  EXPECT_EQ(verdict.text.rfind("do again: ", 0), 0u);
  for (const char* words : {"known to 0.50 mm", "off by 3.00 mm", "has moved"}) {
    EXPECT_NE(verdict.text.find(words), std::string::npos) << verdict.text;
  }
}

TEST(CalibrationVerdict, FramesLeftOutCount) {
  Judged judged;
  judged.fit.frames_used = 80;
  EXPECT_EQ(judged.verdict().grade, CalibrationGrade::kUsable);
  judged.fit.frames_used = 60;
  EXPECT_EQ(judged.verdict().grade, CalibrationGrade::kDoAgain);
}

TEST(CalibrationVerdict, ARegistrationThatTheMotionCannotTestIsSaid) {
  Judged judged;
  judged.target = CalibrationTarget::kWires;
  for (int frame = 0; frame < 100; ++frame) judged.scan.wires.push_back({frame, 0, 0, {1.0, 1.0}});
  EXPECT_EQ(judged.verdict().grade, CalibrationGrade::kUsable);
  EXPECT_NE(judged.verdict().text.find("registration"), std::string::npos);
  judged.fit.fitted[kPhantomTx] = true;  // no registration was used
  EXPECT_EQ(judged.verdict().text, "good");
}

}  // namespace
}  // namespace fathom
