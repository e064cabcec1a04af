#include "segmentation/region_growing.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_resampling.h"
#include "segmentation/outline_topology.h"
#include "segmentation/threshold.h"
#include "tests/segmentation/drawn_images.h"

namespace fathom {
namespace {

using Eigen::Vector2d;
using Outlines = std::vector<Polygon>;

const Vector2d kCentre(80.3, 70.6);

cv::Mat disc_image(double outside, double inside, double noise) {
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(outside));
  draw_disc(clean, kCentre, 40.0, inside);
  return speckled(clean, noise, 1);
}

Outlines grow(const cv::Mat& image, const std::vector<Vector2d>& seeds, const RegionOptions& options = {}) {
  return grow_region(image, seeds, options);
}

TEST(GrowRegion, FindsADiscInSpeckleFromOneSeed) {
  const Outlines right = {circle(kCentre, 40.0, 300)};
  for (const double inside : {50.0, 190.0}) {
    const Outlines region = grow(disc_image(120.0, inside, 20.0), {{70, 60}});
    EXPECT_GT(dice(region, right), 0.97) << inside;
    EXPECT_EQ(outline_fault(region), std::nullopt);
  }
}

TEST(GrowRegion, BordersLieHalfWayBetweenPixels) {
  RegionOptions options;
  options.smoothing_px = 1.0;
  const Outlines region = grow(disc_image(120.0, 50.0, 0.0), {{80, 70}}, options);
  ASSERT_EQ(region.size(), 1u);
  for (const Vector2d& point : region[0]) EXPECT_NEAR((point - kCentre).norm(), 40.0, 0.3);
}

TEST(GrowRegion, DoesNotLeakThroughANeckIntoAStructureThatTouches) {
  cv::Mat clean(140, 200, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, {60, 70}, 38.0, 50.0);
  draw_disc(clean, {139, 70}, 38.0, 50.0);
  clean(cv::Rect(94, 68, 12, 5)).setTo(50.0);  // a bridge of 5 pixels
  const cv::Mat image = speckled(clean, 8.0, 1);
  RegionOptions options;
  options.smoothing_px = 1.0;
  options.neck_px = 8.0;
  const Outlines left = {circle({60, 70}, 38.0, 300)};
  EXPECT_GT(dice(grow(image, {{60, 70}}, options), left), 0.97);
  options.neck_px = 0.0;
  EXPECT_LT(dice(grow(image, {{60, 70}}, options), left), 0.75) << "without a neck it does";
}

TEST(GrowRegion, SeveralSeedsGiveSeveralParts) {
  cv::Mat clean(140, 200, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, {50, 70}, 30.0, 50.0);
  draw_disc(clean, {150, 70}, 30.0, 50.0);
  const Outlines both = grow(speckled(clean, 8.0, 1), {{50, 70}, {150, 70}});
  EXPECT_GT(dice(both, Outlines{circle({50, 70}, 30.0, 200), circle({150, 70}, 30.0, 200)}), 0.97);
}

TEST(GrowRegion, TakesTheRangeThatIsAskedFor) {
  RegionOptions options;
  options.low = 0.0;
  options.high = 85.0;
  EXPECT_GT(dice(grow(disc_image(120.0, 50.0, 10.0), {{80, 70}}, options), Outlines{circle(kCentre, 40.0, 300)}), 0.98);
  options.low = 200.0;
  options.high = 255.0;
  EXPECT_THROW(grow(disc_image(120.0, 50.0, 10.0), {{80, 70}}, options), Error);
}

TEST(GrowRegion, RefusesImagesWithoutABorderAndSeedsOutside) {
  for (const double grey : {0.0, 255.0}) {
    EXPECT_THROW(grow(cv::Mat(60, 60, CV_8U, cv::Scalar(grey)), {{30, 30}}), Error);
  }
  EXPECT_THROW(grow(cv::Mat(), {{30, 30}}), Error);
  const cv::Mat image = disc_image(120.0, 50.0, 10.0);
  EXPECT_THROW(grow(image, {}), Error);
  EXPECT_THROW(grow(image, {{-1, 30}}), Error);
  EXPECT_THROW(grow(image, {{30, std::numeric_limits<double>::infinity()}}), Error);
  RegionOptions options;
  options.low = 9.0;
  options.high = 1.0;
  EXPECT_THROW(grow(image, {{30, 30}}, options), Error);
}

TEST(ThresholdOutlines, TwoThresholdsTakeTheBandBetweenThem) {
  cv::Mat image(140, 160, CV_32F, cv::Scalar(0.0));
  for (int y = 0; y < 140; ++y) {
    for (int x = 0; x < 160; ++x) image.at<float>(y, x) = static_cast<float>(std::hypot(x - 80.0, y - 70.0));
  }
  ThresholdOptions options;
  options.threshold = 20.3;
  options.upper = 50.6;
  const Outlines ring = {circle({80, 70}, 50.6, 400), circle({80, 70}, 20.3, 400)};
  EXPECT_GT(dice(threshold_outlines(image, options), ring), 0.998);
  options.below = true;
  const Outlines others = threshold_outlines(image, options);
  EXPECT_EQ(others.size(), 3u) << "the border of the image, the band as its hole, and the middle";
  options.upper = 3.0;
  EXPECT_THROW(threshold_outlines(image, options), Error);
}

TEST(ThresholdOutlines, SmoothingEvensOutSpeckle) {
  ThresholdOptions options;
  options.threshold = 85.0;
  options.below = true;
  options.min_area_px = 1000.0;
  const cv::Mat image = disc_image(120.0, 50.0, 25.0);
  const double around = 2.0 * std::numbers::pi * 40.0;
  EXPECT_GT(perimeter(threshold_outlines(image, options)[0]), 1.3 * around);
  options.smoothing_px = 3.0;
  EXPECT_NEAR(perimeter(threshold_outlines(image, options)[0]), around, 0.1 * around);
}

}  // namespace
}  // namespace fathom
