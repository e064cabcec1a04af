#include "segmentation/morphology.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"

namespace fathom {
namespace {

constexpr int kDark = 10;
constexpr int kBright = 90;
const Eigen::Vector3d kSides_mm(0.2, 0.35, 1.0);

/// Dark slices of 121 x 71 pixels of unequal sides, turned in space: 24.2 x 24.85 mm.
Volume dark_volume(int depth = CV_8U) {
  const std::array<int, 3> sizes = {3, 71, 121};
  Volume volume = {cv::Mat(3, sizes.data(), depth, cv::Scalar(kDark)), Eigen::Affine3d::Identity()};
  volume.reference_from_voxel.linear() =
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1.0, 1.0, -1.0).normalized()).toRotationMatrix() * kSides_mm.asDiagonal();
  volume.reference_from_voxel.translation() = Eigen::Vector3d(4.0, -3.0, 9.0);
  return volume;
}

cv::Mat slice_of(Volume& volume, int slice) {
  return cv::Mat(volume.voxels.size[1], volume.voxels.size[2], volume.voxels.type(), volume.voxels.ptr(slice));
}

/// Fills a disc around the centre of a slice, moved by (x, y) in millimetres.
void draw_disc(Volume& volume, int slice, double radius_mm, int value, double x_mm = 0.0, double y_mm = 0.0) {
  const cv::Mat image = slice_of(volume, slice);
  cv::Mat inside(image.size(), CV_8U, cv::Scalar(0));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const double x = (column - 60) * kSides_mm.x() - x_mm;
      const double y = (row - 35) * kSides_mm.y() - y_mm;
      if (std::hypot(x, y) <= radius_mm + 1e-9) inside.at<uchar>(row, column) = 1;
    }
  }
  slice_of(volume, slice).setTo(cv::Scalar(value), inside);
}

bool same(const Volume& a, const Volume& b) {
  return a.voxels.type() == b.voxels.type() && a.voxels.size == b.voxels.size &&
         cv::norm(a.voxels, b.voxels, cv::NORM_INF) == 0.0 &&
         a.reference_from_voxel.matrix() == b.reference_from_voxel.matrix();
}

class Morphology : public testing::TestWithParam<int> {};

TEST_P(Morphology, OpeningRemovesASpeckSmallerThanTheDiscAndKeepsALargerOne) {
  Volume volume = dark_volume(GetParam());
  draw_disc(volume, 1, 3.0, kBright);
  const Volume without_speck = volume;
  Volume with_speck = {volume.voxels.clone(), volume.reference_from_voxel};
  draw_disc(with_speck, 1, 1.0, kBright, 30 * kSides_mm.x(), 17 * kSides_mm.y());
  EXPECT_FALSE(same(with_speck, without_speck));
  EXPECT_TRUE(same(open_slices(with_speck, 1.5), open_slices(without_speck, 1.5)));
  // A disc of the size of the speck fits into it.
  Volume kept = open_slices(with_speck, 1.0);
  const cv::Rect around(80, 45, 21, 15);
  EXPECT_EQ(cv::norm(slice_of(kept, 1)(around), slice_of(with_speck, 1)(around), cv::NORM_INF), 0.0);
}

TEST_P(Morphology, ClosingFillsAGapThatTheDiscDoesNotFit) {
  Volume volume = dark_volume(GetParam());
  draw_disc(volume, 2, 8.0, kBright);
  Volume gap = {volume.voxels.clone(), volume.reference_from_voxel};
  // A dark line, 1 mm wide, from side to side.
  slice_of(gap, 2).colRange(58, 63).setTo(cv::Scalar(kDark));
  Volume closed = close_slices(gap, 1.5);
  EXPECT_EQ(cv::countNonZero(slice_of(closed, 2).rowRange(20, 51).colRange(58, 63) != kBright), 0);
  Volume open = close_slices(gap, 0.4);
  EXPECT_EQ(cv::countNonZero(slice_of(open, 2).rowRange(20, 51).colRange(60, 61) != kDark), 0);
}

INSTANTIATE_TEST_SUITE_P(Types, Morphology, testing::Values(CV_8U, CV_8S, CV_16U, CV_16S, CV_32F, CV_64F));

TEST(MorphologyDisc, IsRoundInMillimetresWhateverTheShapeOfAPixel) {
  // Closing the negative of a point by a disc: what opening makes of a bright disc of the very same radius is that
  // disc.
  Volume volume = dark_volume();
  draw_disc(volume, 0, 4.2, kBright);
  EXPECT_TRUE(same(open_slices(volume, 4.2), volume));
  // A disc that is one pixel larger either way fits no longer.
  EXPECT_EQ(cv::countNonZero(open_slices(volume, 4.2 + 0.2).voxels.reshape(1, 1) != kDark), 0);
}

TEST(MorphologyDisc, ALargeDiscKeepsItsArea) {
  Volume volume = dark_volume();
  draw_disc(volume, 1, 9.0, kBright);
  const double pixel_mm2 = kSides_mm.x() * kSides_mm.y();
  const double expected_mm2 = 9.0 * 9.0 * std::numbers::pi;
  for (const double radius_mm : {0.5, 1.0, 3.0}) {
    for (const bool opening : {true, false}) {
      Volume result = opening ? open_slices(volume, radius_mm) : close_slices(volume, radius_mm);
      const double area_mm2 = cv::countNonZero(slice_of(result, 1) == kBright) * pixel_mm2;
      EXPECT_NEAR(area_mm2 / expected_mm2, 1.0, 0.01) << radius_mm << (opening ? " opened" : " closed");
    }
  }
}

TEST(MorphologyDisc, SlicesDoNotAffectEachOther) {
  Volume volume = dark_volume();
  draw_disc(volume, 0, 5.0, kBright);
  draw_disc(volume, 2, 5.0, kBright);
  // Along z, the dark slice between is a gap; it stays.
  Volume closed = close_slices(volume, 3.0);
  EXPECT_EQ(cv::countNonZero(slice_of(closed, 1) != kDark), 0);
}

TEST(MorphologyDisc, TheBorderOfASliceIsNoEdge) {
  Volume bright = dark_volume();
  bright.voxels.setTo(cv::Scalar(kBright));
  EXPECT_TRUE(same(open_slices(bright, 2.0), bright));
  EXPECT_TRUE(same(close_slices(dark_volume(), 2.0), dark_volume()));
  // Nor does a disc larger than the slice do harm.
  EXPECT_TRUE(same(open_slices(bright, 1e6), bright));
}

TEST(MorphologyDisc, OneSmallerThanAPixelChangesNothing) {
  Volume volume = dark_volume();
  slice_of(volume, 1).at<uchar>(3, 4) = kBright;
  EXPECT_TRUE(same(open_slices(volume, 0.19), volume));
  EXPECT_FALSE(same(open_slices(volume, 0.2), volume));
}

TEST(MorphologyDisc, WhatCannotBeFilteredIsRefused) {
  const Volume volume = dark_volume();
  for (const double radius_mm :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(open_slices(volume, radius_mm), Error);
    EXPECT_THROW(close_slices(volume, radius_mm), Error);
  }
  EXPECT_THROW(open_slices({}, 1.0), Error);
  EXPECT_THROW(open_slices(dark_volume(CV_32S), 1.0), Error);
  EXPECT_THROW(open_slices(dark_volume(CV_8UC3), 1.0), Error);
}

}  // namespace
}  // namespace fathom
