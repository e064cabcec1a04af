#include "registration/wall_detection.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace fathom {
namespace {

const cv::Size kSize(640, 480);

// A floor whose echo rises within two pixels at its upper edge, is `thickness` thick, and rings on below.
cv::Mat floor_image(double at, double slope, double thickness, double ringing, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(kSize, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double depth = y - (at + slope * x);
      double value = 15.0 * std::hypot(random.normal(), random.normal());
      value += 200.0 / (1.0 + std::exp(-2.0 * depth)) / (1.0 + std::exp(2.0 * (depth - thickness)));
      const double second = depth - 30.0;
      value += ringing * 200.0 / (1.0 + std::exp(-2.0 * second)) / (1.0 + std::exp(2.0 * (second - thickness)));
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  return image;
}

TEST(WallDetection, FindsTheUpperEdgeWhateverTheThickness) {
  Random random(2);
  for (const double thickness : {6.0, 10.0, 16.0}) {
    const double at = random.uniform(200, 300);
    const double slope = random.uniform(-0.2, 0.2);
    const auto wall = detect_wall_in_image(floor_image(at, slope, thickness, 0.5, 4));
    ASSERT_TRUE(wall);
    EXPECT_NEAR(wall->point_px.y(), at + slope * wall->point_px.x(), 0.5) << thickness;
    EXPECT_NEAR(wall->direction.y() / wall->direction.x(), slope, 2e-3);
    EXPECT_LT(wall->sigma_px, 1.0);
    EXPECT_GT(wall->sigma_px, 0.0);
  }
}

TEST(WallDetection, ABrighterReverberationDoesNotPullItDown) {
  const auto wall = detect_wall_in_image(floor_image(220.0, 0.05, 8.0, 1.15, 4));
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->point_px.y(), 220.0 + 0.05 * wall->point_px.x(), 0.5);
}

TEST(WallDetection, SpeckleAndBlackHaveNoWall) {
  EXPECT_FALSE(detect_wall_in_image(cv::Mat(kSize, CV_8UC1, cv::Scalar(0))));
  EXPECT_FALSE(detect_wall_in_image(floor_image(1000.0, 0.0, 8.0, 0.0, 4)));
}

MemoryRecording recording_of(std::vector<cv::Mat> images) {
  RecordingHeader header;
  header.width = kSize.width;
  header.height = kSize.height;
  header.pixel_type = CV_8UC1;
  header.frames.resize(images.size());
  return MemoryRecording("scan", std::move(header), std::move(images));
}

TEST(WallDetection, FramesKeepTheirNumbersAndNoWallAtAllIsAnError) {
  const cv::Mat black(kSize, CV_8UC1, cv::Scalar(0));
  const auto walls =
      detect_wall(recording_of({black, floor_image(200, 0, 8, 0, 1), black, floor_image(250, 0, 8, 0, 2)}));
  ASSERT_EQ(walls.size(), 2u);
  EXPECT_EQ(walls[0].frame, 1);
  EXPECT_EQ(walls[1].frame, 3);
  EXPECT_NEAR(walls[1].point_px.y() - walls[0].point_px.y(), 50.0, 0.5);
  EXPECT_THROW(detect_wall(recording_of({black})), Error);
}

TEST(PointDetection, FindsTheBrightestBlobAndRefusesRivals) {
  const auto image = [](double second) {
    cv::Mat bytes(kSize, CV_8UC1);
    for (int y = 0; y < bytes.rows; ++y) {
      for (int x = 0; x < bytes.cols; ++x) {
        const double one = std::hypot((x - 300.3) / 4.0, (y - 200.7) / 2.0);
        const double two = std::hypot((x - 400.0) / 4.0, (y - 300.0) / 2.0);
        bytes.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(200.0 * std::exp(-one * one / 2.0) + second * std::exp(-two * two / 2.0));
      }
    }
    return bytes;
  };
  const auto points = detect_point(recording_of({image(0.0), image(190.0), image(80.0)}));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].frame, 0);
  EXPECT_EQ(points[1].frame, 2);
  EXPECT_LT((points[0].position_px - Eigen::Vector2d(300.3, 200.7)).norm(), 0.05);
}

}  // namespace
}  // namespace fathom
