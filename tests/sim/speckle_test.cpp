#include "sim/speckle.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {
namespace {

const cv::Size kSize(400, 400);

Eigen::Affine3d plane_at(const Eigen::Vector3d& shift_mm) {
  Eigen::Affine3d plane = Eigen::Affine3d::Identity();
  plane.linear() = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -2).normalized()).toRotationMatrix() * 0.1;
  plane.translation() = Eigen::Vector3d(-310, 27, 88) + plane.linear() * shift_mm / 0.1;
  return plane;
}

double mean_of(const cv::Mat& values) { return cv::mean(values)[0]; }

/// Correlation of the intensities of two images.
double correlation(const cv::Mat& first, const cv::Mat& second) {
  cv::Mat a = first.mul(first);
  cv::Mat b = second.mul(second);
  a -= mean_of(a);
  b -= mean_of(b);
  return mean_of(a.mul(b)) / std::sqrt(mean_of(a.mul(a)) * mean_of(b.mul(b)));
}

TEST(Speckle, AmplitudesAreRayleighDistributed) {
  const SpeckleField field{SpeckleOptions{}};
  double mean = 0.0;
  double square = 0.0;
  for (int i = 0; i < 4; ++i) {
    const cv::Mat amplitude = field.amplitude(plane_at({0, 0, 3.0 * i}), kSize);
    mean += mean_of(amplitude) / 4;
    square += mean_of(amplitude.mul(amplitude)) / 4;
  }
  EXPECT_NEAR(square, 1.0, 0.03);
  EXPECT_NEAR(mean / std::sqrt(square - mean * mean), 1.91, 0.05);
}

// The response to a point is a Gaussian of standard deviation s; intensities then correlate as exp(-d^2 / (2 s^2)).
TEST(Speckle, CorrelationLengthsAreThoseSet) {
  const SpeckleOptions options;
  const SpeckleField field(options);
  const Eigen::Vector3d sigma = Eigen::Vector3d(options.lateral_mm, options.axial_mm, options.elevation_mm) / 2.3548;
  const cv::Mat still = field.amplitude(plane_at({0, 0, 0}), kSize);
  for (int axis = 0; axis < 2; ++axis) {
    for (const int pixels : {2, 4}) {
      const cv::Rect moved(axis == 0 ? pixels : 0, axis == 1 ? pixels : 0, 390, 390);
      const double d = 0.1 * pixels / sigma[axis];
      EXPECT_NEAR(correlation(still(moved), still(cv::Rect(0, 0, 390, 390))), std::exp(-d * d / 2.0), 0.06)
          << "axis " << axis << ", " << pixels << " pixels";
    }
  }
}

TEST(Speckle, NeighbouringFramesShareTheirTextureAsFarAsTheyOverlap) {
  const SpeckleOptions options;
  const SpeckleField field(options);
  const cv::Mat still = field.amplitude(plane_at({0, 0, 0}), kSize);
  const double sigma = options.elevation_mm / 2.3548;
  for (const double share : {0.5, 1.0, 1.5}) {
    const cv::Mat moved = field.amplitude(plane_at({0, 0, share * sigma}), kSize);
    EXPECT_NEAR(correlation(still, moved), std::exp(-share * share / 2.0), 0.12) << share;
  }
  EXPECT_LT(std::abs(correlation(still, field.amplitude(plane_at({0, 0, 5.0 * sigma}), kSize))), 0.05);
  // A probe moved along the image sees the same texture shifted.
  const cv::Mat along = field.amplitude(plane_at({2.0, 0, 0}), kSize);
  EXPECT_GT(correlation(still(cv::Rect(30, 10, 360, 380)), along(cv::Rect(10, 10, 360, 380))), 0.97);
}

TEST(Speckle, DoesNotRepeatWithin200Millimetres) {
  const SpeckleField field{SpeckleOptions{}};
  Eigen::Affine3d plane = Eigen::Affine3d::Identity();
  plane.linear() *= 0.1;
  const cv::Mat strip = field.amplitude(plane, {2100, 80});
  cv::Mat alike;
  cv::matchTemplate(strip, strip(cv::Rect(0, 0, 80, 80)), alike, cv::TM_CCOEFF_NORMED);
  EXPECT_GT(alike.at<float>(0, 0), 0.999F);
  double most = 0.0;
  cv::minMaxLoc(alike.colRange(30, alike.cols), nullptr, &most);
  EXPECT_LT(most, 0.35);
}

TEST(Speckle, TheSameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  const cv::Mat inside(kSize, CV_8UC1, cv::Scalar(0));
  const auto image = [&](std::uint64_t seed, int threads) {
    SpeckleOptions options;
    options.seed = seed;
    const int before = cv::getNumThreads();
    cv::setNumThreads(threads);
    const cv::Mat result = speckled_image(SpeckleField(options), options, inside, plane_at({0, 0, 0}));
    cv::setNumThreads(before);
    return result;
  };
  EXPECT_EQ(cv::countNonZero(image(3, 1) != image(3, 2)), 0);
  EXPECT_GT(cv::countNonZero(image(3, 1) != image(4, 1)), 1000);
}

TEST(Speckle, ObjectsAreDarkerAndBoundariesAcrossTheBeamBrighter) {
  cv::Mat inside(kSize, CV_8UC1, cv::Scalar(0));
  inside(cv::Rect(100, 100, 200, 200)).setTo(255);
  SpeckleOptions options;
  options.attenuation_db_per_mm = 0.0;
  const cv::Mat image = speckled_image(SpeckleField(options), options, inside, plane_at({0, 0, 0}));
  const double tissue = mean_of(image(cv::Rect(10, 10, 80, 380)));
  const double within = mean_of(image(cv::Rect(130, 130, 140, 140)));
  const double top = mean_of(image(cv::Rect(130, 98, 140, 4)));
  const double side = mean_of(image(cv::Rect(98, 130, 4, 140)));
  EXPECT_NEAR(tissue - within, -options.structure_db * 255.0 / options.dynamic_range_db, 8.0);
  EXPECT_GT(top, tissue + 40.0);
  EXPECT_LT(side, tissue + 10.0);
}

TEST(Speckle, DepthAttenuates) {
  SpeckleOptions options;
  options.attenuation_db_per_mm = 0.3;
  const cv::Mat inside(kSize, CV_8UC1, cv::Scalar(0));
  const cv::Mat image = speckled_image(SpeckleField(options), options, inside, plane_at({0, 0, 0}));
  const double shallow = mean_of(image(cv::Rect(0, 0, 400, 100)));
  const double deep = mean_of(image(cv::Rect(0, 200, 400, 100)));
  EXPECT_NEAR(shallow - deep, 20.0 * 0.3 * 255.0 / options.dynamic_range_db, 6.0);
}

TEST(Speckle, AFanIsBlackAroundTheSector) {
  cv::Mat image(kSize, CV_8UC1, cv::Scalar(9));
  blacken_outside_fan(image, 100.0, 120.0, 0.5);
  EXPECT_EQ(image.at<std::uint8_t>(300, 199), 9);
  EXPECT_EQ(image.at<std::uint8_t>(10, 199), 0);  // the probe's face
  EXPECT_EQ(image.at<std::uint8_t>(50, 10), 0);   // beside the sector
}

TEST(Speckle, OptionsOutOfRangeAreRefused) {
  SpeckleOptions options;
  options.axial_mm = 0.0;
  EXPECT_THROW(SpeckleField{options}, Error);
}

}  // namespace
}  // namespace fathom
