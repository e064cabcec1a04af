#include "registration/calibration_scan.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/registration/target_scans.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr int kRows = 800;  // the deepest floor is in view

// A floor's echo: its upper edge at half height where the line is, some pixels thick.
cv::Mat floor_image(const WallLine& line) {
  cv::Mat image = cv::Mat::zeros(kRows, kScanWidth_px, CV_8UC1);
  for (int x = 0; x < image.cols; ++x) {
    const double y = line.point_px.y() + (x - line.point_px.x()) * line.direction.y() / line.direction.x();
    for (int row = std::max(0, static_cast<int>(y) - 2); row < std::min<double>(image.rows, y + 10.0); ++row) {
      image.at<unsigned char>(row, x) = static_cast<unsigned char>(200.0 * std::clamp(row - y + 0.5, 0.0, 1.0));
    }
  }
  return image;
}

cv::Mat spot_image(const SpotPoint& point) {
  cv::Mat image = cv::Mat::zeros(kRows, kScanWidth_px, CV_8UC1);
  constexpr int kReach = 12;
  const cv::Point middle(static_cast<int>(point.position_px.x()), static_cast<int>(point.position_px.y()));
  const cv::Rect around = cv::Rect(middle.x - kReach, middle.y - kReach, 2 * kReach + 1, 2 * kReach + 1) &
                          cv::Rect(cv::Point(0, 0), image.size());
  for (int y = around.y; y < around.br().y; ++y) {
    for (int x = around.x; x < around.br().x; ++x) {
      const double squared = (Eigen::Vector2d(x, y) - point.position_px).squaredNorm();
      image.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(220.0 * std::exp(-squared / 18.0)));
    }
  }
  return image;
}

EditableRecording recording_of(const TargetScan& scan) {
  RecordingHeader header;
  header.width = kScanWidth_px;
  header.height = kRows;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker"};
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < scan.poses.size(); ++i) {
    FrameHeader frame;
    frame.time_s = scan.times_s[i];
    frame.poses = {Pose{scan.poses[i]->matrix(), "OK"}};
    header.frames.push_back(frame);
    images.push_back(scan.lines.empty() ? spot_image(scan.points[i]) : floor_image(scan.lines[i]));
  }
  return {"scan.mha", std::move(header), std::move(images)};
}

class CalibrationFromImages : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Phantoms, CalibrationFromImages, testing::Values("wall", "point"),
                         [](const auto& phantom) { return std::string(phantom.param); });

TEST_P(CalibrationFromImages, IsTheTruth) {
  Random random(61);
  TargetScanning how;
  how.noise_px = 0.0;
  how.frames = 60;
  const TargetScan made = scan_target(how, GetParam() == std::string("wall"), random);
  const EditableRecording recording = recording_of(made);
  const CalibrationPhantom phantom = calibration_phantom(GetParam(), {});
  CalibrationScan scan = scan_phantom(recording, find_pose_chain(recording, {}), phantom, {});
  EXPECT_GE(scan.frames_with_target, 50);
  ScanFitOptions options;
  options.try_latency = options.try_skew = false;
  const SpatialFit fit = calibrate_scan(scan, phantom, options);
  EXPECT_LT(farthest_mm(fit.state, made.truth, kScanWidth_px, kRows), 0.5);
  const ScanErrors errors = scan_errors(scan, phantom, fit.state);
  EXPECT_LT(errors.mean_mm, 0.1);
  EXPECT_FALSE(errors.wire_mean_mm);
  EXPECT_GE(residuals(scan, phantom, fit.state).size(), 50u);
}

TEST(CalibrationPhantom, IsAFileUnlessItIsNamed) {
  EXPECT_EQ(calibration_phantom("wall", {}).target, CalibrationTarget::kWall);
  EXPECT_EQ(calibration_phantom("point", {}).target, CalibrationTarget::kPoint);
  EXPECT_THROW(calibration_phantom("floor", {}), Error);
}

}  // namespace
}  // namespace fathom
