#include "segmentation/threshold.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/random.h"
#include "segmentation/outline_topology.h"

namespace fathom {
namespace {

double area(const Polygon& outline) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(0.5 * twice);
}

bool inside(const std::vector<Polygon>& outlines, double x, double y) {
  bool in = false;
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
      if ((a.y() <= y) != (b.y() <= y) && x < a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) in = !in;
    }
  }
  return in;
}

std::string fault(const std::vector<Polygon>& outlines) {
  std::vector<const Polygon*> pointers;
  for (const Polygon& outline : outlines) pointers.push_back(&outline);
  return outline_fault(pointers).value_or("");
}

// A cone of grey values around (x, y), equal to 100 at `radius` from it.
cv::Mat cone(int width, int height, double x, double y, double radius) {
  cv::Mat image(height, width, CV_32F);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      image.at<float>(row, col) = static_cast<float>(100.0 + radius - std::hypot(col - x, row - y));
    }
  }
  return image;
}

ThresholdOptions at(double threshold, double min_area_px = 0.0) {
  ThresholdOptions options;
  options.threshold = threshold;
  options.min_area_px = min_area_px;
  return options;
}

TEST(ThresholdOutlines, OfABinaryDiscEncloseItsArea) {
  for (const double radius : {20.0, 50.5, 100.0}) {
    const cv::Mat image = cone(260, 240, 128.3, 118.8, radius) >= 100.0;
    const auto outlines = threshold_outlines(image, at(127.5));
    ASSERT_EQ(outlines.size(), 1u);
    const double disc = std::numbers::pi * radius * radius;
    // A binary border is off by a fraction of a pixel at random; the area's error is that of a few border pixels.
    EXPECT_NEAR(area(outlines[0]), disc, 2.0 * std::sqrt(radius)) << radius;
  }
}

TEST(ThresholdOutlines, OfASmoothDiscLieOnItsCircleToAHundredthOfAPixel) {
  const auto outlines = threshold_outlines(cone(120, 110, 61.3, 52.7, 40.0), at(100.0));
  ASSERT_EQ(outlines.size(), 1u);
  for (const Eigen::Vector2d& point : outlines[0]) {
    EXPECT_NEAR(std::hypot(point.x() - 61.3, point.y() - 52.7), 40.0, 0.01);
  }
}

TEST(ThresholdOutlines, OfARampAreAtTheExactSubPixelPlace) {
  cv::Mat image(9, 40, CV_16U);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 40; ++x) image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(1000 * x);
  }
  const auto outlines = threshold_outlines(image, at(12300.0));
  ASSERT_EQ(outlines.size(), 1u);
  double left = 1e9;
  for (const Eigen::Vector2d& point : outlines[0]) left = std::min(left, point.x());
  EXPECT_NEAR(left, 12.3, 1e-12);
}

TEST(ThresholdOutlines, CountAPixelAtTheThresholdAsInside) {
  cv::Mat image = cv::Mat::zeros(5, 5, CV_8U);
  image.at<std::uint8_t>(2, 2) = 100;
  EXPECT_EQ(threshold_outlines(image, at(100.0)).size(), 1u);
  EXPECT_EQ(threshold_outlines(image, at(100.5)).size(), 0u);
  ThresholdOptions below = at(100.0);
  below.below = true;
  const auto outlines = threshold_outlines(image, below);  // all but that pixel
  ASSERT_EQ(outlines.size(), 2u);
  EXPECT_FALSE(inside(outlines, 2.0, 2.0));
  EXPECT_TRUE(inside(outlines, 2.0, 3.0));
}

TEST(ThresholdOutlines, GiveHolesAndSeveralPartsLargestFirst) {
  cv::Mat image = cv::Mat::zeros(60, 90, CV_8U);
  image(cv::Rect(5, 5, 10, 8)).setTo(255);
  image(cv::Rect(30, 10, 40, 40)).setTo(255);
  image(cv::Rect(40, 20, 20, 20)).setTo(0);
  image(cv::Rect(48, 28, 4, 4)).setTo(255);
  const auto outlines = threshold_outlines(image, at(127.5));
  ASSERT_EQ(outlines.size(), 4u);
  // A corner cuts an eighth off a rectangle's area; a hole's corners add to it.
  EXPECT_NEAR(area(outlines[0]), 40 * 40 - 0.5, 1e-9);
  EXPECT_NEAR(area(outlines[1]), 20 * 20 - 0.5, 1e-9);
  EXPECT_NEAR(area(outlines[2]), 10 * 8 - 0.5, 1e-9);
  EXPECT_NEAR(area(outlines[3]), 4 * 4 - 0.5, 1e-9);
  EXPECT_TRUE(inside(outlines, 35, 30));
  EXPECT_FALSE(inside(outlines, 42, 30));
  EXPECT_TRUE(inside(outlines, 50, 30));
}

TEST(ThresholdOutlines, AreClosedHalfAPixelOutsideOfTheImage) {
  for (const int type : {CV_8U, CV_32F}) {
    const auto outlines = threshold_outlines(cv::Mat(20, 30, type, cv::Scalar(200)), at(127.5));
    ASSERT_EQ(outlines.size(), 1u);
    EXPECT_NEAR(area(outlines[0]), 20 * 30 - 0.5, 1e-9);
    for (const Eigen::Vector2d& point : outlines[0]) {
      EXPECT_GE(point.minCoeff(), -0.5);
      EXPECT_LE(point.x(), 29.5);
      EXPECT_LE(point.y(), 19.5);
    }
  }
}

TEST(ThresholdOutlines, FilledByEvenOddGiveThePixelsBackForAnyImageOfAnyType) {
  Random random(5);
  for (int round = 0; round < 60; ++round) {
    const int type = std::array{CV_8U, CV_8S, CV_16U, CV_16S, CV_32S, CV_32F, CV_64F, CV_16F}[round % 8u];
    const int levels = round % 3 == 0 ? 2 : 9;  // many pixels lie exactly at the threshold
    cv::Mat values(17, 23, CV_64F);
    for (int y = 0; y < values.rows; ++y) {
      for (int x = 0; x < values.cols; ++x) values.at<double>(y, x) = std::floor(random.uniform(0.0, levels));
    }
    cv::Mat image;
    values.convertTo(image, type == CV_16F ? CV_32F : type);
    if (type == CV_16F) image.convertTo(image, CV_16F);
    ThresholdOptions options = at(levels / 2);
    options.below = round % 5 == 0;
    const auto outlines = threshold_outlines(image, options);
    ASSERT_EQ(fault(outlines), "") << "round " << round;
    for (int y = -1; y <= values.rows; ++y) {
      for (int x = -1; x <= values.cols; ++x) {
        const bool in_image = x >= 0 && y >= 0 && x < values.cols && y < values.rows;
        const bool expected = in_image && (values.at<double>(y, x) >= options.threshold) != options.below;
        ASSERT_EQ(inside(outlines, x, y), expected) << "round " << round << " at " << x << ", " << y;
      }
    }
  }
}

TEST(ThresholdOutlines, DropSpecksAndPinholes) {
  cv::Mat image = cv::Mat::zeros(50, 50, CV_8U);
  image(cv::Rect(10, 10, 30, 30)).setTo(255);
  image.at<std::uint8_t>(20, 20) = 0;
  image.at<std::uint8_t>(2, 2) = 255;
  EXPECT_EQ(threshold_outlines(image, at(127.5)).size(), 3u);
  EXPECT_EQ(threshold_outlines(image, at(127.5, 4.0)).size(), 1u);
}

TEST(ThresholdOutlines, StayFiniteWhereValuesAreNot) {
  cv::Mat image = cv::Mat::zeros(8, 8, CV_32F);
  image(cv::Rect(2, 2, 4, 4)).setTo(std::numeric_limits<float>::infinity());
  image.at<float>(2, 2) = std::numeric_limits<float>::quiet_NaN();
  image.at<float>(3, 1) = -std::numeric_limits<float>::infinity();
  const auto outlines = threshold_outlines(image, at(1.0));
  ASSERT_EQ(outlines.size(), 1u);
  for (const Eigen::Vector2d& point : outlines[0]) EXPECT_TRUE(point.allFinite());
}

TEST(ThresholdOutlines, WorkOnAPartOfAnImage) {
  cv::Mat image = cv::Mat::zeros(40, 40, CV_8U);
  image(cv::Rect(10, 10, 10, 10)).setTo(255);
  const auto outlines = threshold_outlines(image(cv::Rect(5, 8, 30, 20)), at(127.5));
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_TRUE(inside(outlines, 5.0, 2.0));
  EXPECT_FALSE(inside(outlines, 15.0, 2.0));
}

TEST(ThresholdOutlines, RefuseColourAndOptionsWithoutMeaning) {
  EXPECT_THROW(threshold_outlines(cv::Mat::zeros(4, 4, CV_8UC3), {}), Error);
  EXPECT_THROW(threshold_outlines(cv::Mat::zeros(4, 4, CV_8U), at(std::nan(""))), Error);
  EXPECT_THROW(threshold_outlines(cv::Mat::zeros(4, 4, CV_8U), at(1.0, -1.0)), Error);
  EXPECT_TRUE(threshold_outlines(cv::Mat(), {}).empty());
}

}  // namespace
}  // namespace fathom
