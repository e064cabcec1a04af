#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/real_recordings.h"
#include "tests/registration/pictures.h"

namespace fathom {
namespace {

class ResliceOfTypes : public testing::TestWithParam<int> {};

TEST_P(ResliceOfTypes, InThePlaneOfAFrameIsThatFrame) {
  Random random(3);
  const Eigen::Vector2d square(0.3, 0.3);
  const bool is_signed = CV_MAT_DEPTH(GetParam()) == CV_8S || CV_MAT_DEPTH(GetParam()) == CV_16S;
  const PlacedScan scan =
      scan_of(trembling_poses(random, kFrames, 1.0, 0.2, 0.02), kSize, square, GetParam(),
              [&](int frame, const Eigen::Vector3d& at) { return texture(frame, at) - (is_signed ? 128.0 : 0.0); });
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  for (const int frame : {0, 1, kFrames / 2, kFrames - 1}) {
    const Eigen::Affine3d map = scan.map(frame);
    const ReslicePlane plane{map.translation(), map.linear().col(0), map.linear().col(1), kSize, 0.3};
    for (const ResliceMode mode : {ResliceMode::kNearest, ResliceMode::kLinear}) {
      const Resliced made = reslicer.reslice(plane_surface(plane), {mode, 0.0});
      EXPECT_TRUE(equal(made.picture, scan.recording->image(frame))) << frame;
      EXPECT_EQ(made.covered_share(), 1.0) << frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Types, ResliceOfTypes, testing::Values(CV_8U, CV_8S, CV_16U, CV_16S));

double linear_field(const Eigen::Vector3d& at) { return 20000.0 + Eigen::Vector3d(300.0, -250.0, 500.0).dot(at); }
constexpr double kSteepest = 640.4;  // of the field, per mm

// Frames that are not parallel. What is left of a linear field is the difference of their normals, at most a quarter of
// the gap apart from either.
TEST(Reslice, LinearKeepsALinearFieldAndNearestIsOffByHalfAGap) {
  Random random(12);
  const auto poses = trembling_poses(random, kFrames, 0.8, 0.15, 0.02);
  const PlacedScan scan =
      scan_of(poses, {80, 80}, {0.25, 0.25}, CV_16U, [](int, const Eigen::Vector3d& at) { return linear_field(at); });
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  double turn_rad = 0.0, gap_mm = 0.0;
  for (int f = 1; f < kFrames; ++f) {
    const Eigen::Vector3d a = frame_normal(scan.map(f - 1));
    const Eigen::Vector3d b = frame_normal(scan.map(f));
    turn_rad = std::max(turn_rad, (a - b).norm());
    for (const double x : {0.0, 79.0}) {
      for (const double y : {0.0, 79.0}) {
        const Eigen::Vector3d corner = scan.map(f) * Eigen::Vector3d(x, y, 0);
        gap_mm = std::max(gap_mm, std::abs(a.dot(corner - scan.map(f - 1).translation())));
      }
    }
  }
  const double between_normals = 0.25 * gap_mm * turn_rad * kSteepest;
  ASSERT_LT(between_normals, 20.0);  // of 800 that lie between two frames
  double squares_nearest = 0.0, squares_linear = 0.0;
  int count = 0;
  for (int trial = 0; trial < 5; ++trial) {
    ReslicePlane plane = random_plane(random, 0.8 * kFrames, 32);
    plane.origin_mm += Eigen::Vector3d(0.0, 4.0, 0.0);
    const ResliceSurface surface = plane_surface(plane);
    const Resliced nearest = reslicer.reslice(surface, {ResliceMode::kNearest, 0.0});
    const Resliced linear = reslicer.reslice(surface, {ResliceMode::kLinear, 0.0});
    ASSERT_EQ(linear.covered_share(), 1.0);
    for (int y = 0; y < plane.size.height; ++y) {
      for (int x = 0; x < plane.size.width; ++x) {
        const double truth = linear_field(place(surface, x, y));
        const double off_linear = value(linear.picture, x, y) - truth;
        const double off_nearest = value(nearest.picture, x, y) - truth;
        // Rounded in the frames and in the picture; places are rounded to 1/4096 of a pixel.
        ASSERT_LE(std::abs(off_linear), 1.0 + 0.1 + between_normals) << x << " " << y;
        ASSERT_LE(std::abs(off_nearest), 1.0 + kSteepest * std::hypot(0.5 * gap_mm, 0.125 * std::sqrt(2.0)));
        squares_linear += off_linear * off_linear;
        squares_nearest += off_nearest * off_nearest;
        ++count;
      }
    }
  }
  EXPECT_LT(std::sqrt(squares_linear / count), 2.0);
  EXPECT_GT(std::sqrt(squares_nearest / count), 50.0);
}

TEST(Reslice, MeanOfASlabOfALinearFieldIsItsMiddleAndMaximumItsTop) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 40; ++i) poses.emplace_back(Eigen::Translation3d(0.0, 0.0, 0.5 * i));
  const PlacedScan scan =
      scan_of(poses, {80, 80}, {0.25, 0.25}, CV_16U, [](int, const Eigen::Vector3d& at) { return linear_field(at); });
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  Random random(2);
  for (int trial = 0; trial < 4; ++trial) {
    ReslicePlane plane = random_plane(random, 20.0, 24);
    plane.origin_mm += Eigen::Vector3d(0.0, 4.0, 0.0);
    const ResliceSurface surface = plane_surface(plane);
    const double thickness_mm = 3.0;
    const Resliced mean = reslicer.reslice(surface, {ResliceMode::kMean, thickness_mm});
    const Resliced most = reslicer.reslice(surface, {ResliceMode::kMax, thickness_mm});
    const double across = std::abs(linear_field(surface.rows[0].normal) - linear_field(Eigen::Vector3d::Zero()));
    const int layers = static_cast<int>(std::ceil(thickness_mm / plane.spacing_mm));
    const double to_top_mm = 0.5 * thickness_mm * (1.0 - 1.0 / layers);
    for (int y = 0; y < plane.size.height; ++y) {
      for (int x = 0; x < plane.size.width; ++x) {
        const double truth = linear_field(place(surface, x, y));
        ASSERT_NEAR(value(mean.picture, x, y), truth, 1.1);
        ASSERT_NEAR(value(most.picture, x, y), truth + across * to_top_mm,
                    1.0 + kSteepest * std::hypot(0.25, 0.125 * std::sqrt(2.0)));
      }
    }
  }
}

// A calibration whose image axes are not perpendicular, by 3 degrees: pixels are where the calibration says.
TEST(SpineSweep, ComesBackInThePlaneOfEachOfItsFrames) {
  const std::filesystem::path folder = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const auto recording = open_recording(folder / "SpinePhantomFreehand.igs.mha");
  const FrameLocator locator(*recording,
                             read_calibration(folder / "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"));
  const cv::Size size(recording->header().width, recording->header().height);
  const auto frames = placed_frames(*recording, locator);
  const Reslicer reslicer(*recording, locator, {{0, 0, locator.frame_count() - 1}});
  for (const PlacedFrame& frame : {frames.front(), frames[10], frames.back()}) {
    const ResliceSurface surface = plane_surface(plane_through(frame, 0.0, frames, size, 0.31));
    const Resliced made = reslicer.reslice(surface);
    const cv::Mat image = recording->image(frame.frame);
    const Eigen::Affine3d image_from_reference = frame.reference_from_image.inverse();
    int compared = 0;
    for (int y = 0; y < made.picture.rows; ++y) {
      for (int x = 0; x < made.picture.cols; ++x) {
        const Eigen::Vector3d at = image_from_reference * place(surface, x, y);
        const cv::Point pixel(static_cast<int>(std::floor(at.x() + 0.5)), static_cast<int>(std::floor(at.y() + 0.5)));
        const bool inside = cv::Rect({0, 0}, size).contains(pixel);
        ASSERT_EQ(made.covered.at<std::uint8_t>(y, x) != 0, inside) << x << " " << y;
        if (!inside) continue;
        ASSERT_EQ(made.picture.at<std::uint8_t>(y, x), image.at<std::uint8_t>(pixel)) << x << " " << y;
        ++compared;
      }
    }
    EXPECT_GT(compared, 30000);
  }
}

// How far pictures are from the truth: a texture of waves in all directions, no shorter than 2 mm, as the speckle of a
// scanner's slice thickness is not. The table is printed for docs/results.md.
TEST(ResliceAccuracy, LinearIsCloserToTheTextureThanNearest) {
  Random random(21);
  struct Wave {
    Eigen::Vector3d per_mm;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    waves.push_back({2.0 * std::numbers::pi / random.uniform(2.0, 6.0) * direction, random.uniform(0.0, 6.3)});
  }
  const auto grey = [&waves](const Eigen::Vector3d& at) {
    double sum = 0.0;
    for (const Wave& wave : waves) sum += std::cos(wave.per_mm.dot(at) + wave.phase);
    return 128.0 + 30.0 * std::sqrt(2.0 / static_cast<double>(waves.size())) * sum;  // standard deviation of 30
  };
  double last_linear = 0.0;
  for (const double step_mm : {0.25, 0.5, 1.0}) {
    const int count = static_cast<int>(12.0 / step_mm);
    const PlacedScan scan = scan_of(trembling_poses(random, count, step_mm, 0.1 * step_mm, 0.01), {70, 70}, {0.2, 0.2},
                                    CV_8U, [&](int, const Eigen::Vector3d& at) { return grey(at); });
    const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
    const ReslicePlane plane{{3.0, 2.0, 1.5}, {0.5, 0.1, 1.0}, {0.0, 1.0, -0.1}, {45, 45}, 0.2};
    const ResliceSurface surface = plane_surface(plane);
    double rms[2] = {0.0, 0.0};
    for (const ResliceMode mode : {ResliceMode::kNearest, ResliceMode::kLinear}) {
      const Resliced made = reslicer.reslice(surface, {mode, 0.0});
      ASSERT_EQ(made.covered_share(), 1.0);
      double squares = 0.0;
      for (int y = 0; y < 45; ++y) {
        for (int x = 0; x < 45; ++x) {
          const double off = made.picture.at<std::uint8_t>(y, x) - grey(place(surface, x, y));
          squares += off * off;
        }
      }
      rms[mode == ResliceMode::kLinear ? 1 : 0] = std::sqrt(squares / (45.0 * 45.0));
    }
    std::printf("frames every %.2f mm: rms nearest %.2f, linear %.2f\n", step_mm, rms[0], rms[1]);
    EXPECT_LT(rms[1], 0.6 * rms[0]);
    EXPECT_GT(rms[1], last_linear);
    last_linear = rms[1];
  }
}

}  // namespace
}  // namespace fathom
