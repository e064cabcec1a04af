#include "registration/reslice_surface.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/registration/pictures.h"

namespace fathom {
namespace {

TEST(Reslice, OfASurfaceSweptAlongACurveIsFlat) {
  Random random(9);
  const auto pattern = [](double along, double down) {
    return 128.0 + 100.0 * std::sin(0.8 * along) * std::cos(1.1 * down);
  };
  // A wavy sheet: places on it have the pattern of their way along it. Its polyline turns by 0.6 rad at x = 6.
  const Eigen::Vector3d a(2.0, 1.0, 2.0), b(6.0, 1.0, 6.0), c(11.0, 1.0, 8.0);
  const double bend = (b - a).norm();
  const auto along = [&](const Eigen::Vector3d& at) {
    const Eigen::Vector3d level(at.x(), 1.0, at.z());
    const double first = (level - a).dot((b - a).normalized());
    return first < bend ? first : bend + std::max(0.0, (level - b).dot((c - b).normalized()));
  };
  const PlacedScan scan = scan_of(trembling_poses(random, 50, 0.2, 0.02, 0.005), {120, 80}, {0.1, 0.1}, CV_8U,
                                  [&](int, const Eigen::Vector3d& at) { return pattern(along(at), at.y()); });
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  const ResliceSurface surface = curved_surface({a, b + Eigen::Vector3d(0, 3, 0), c}, {0, 2, 0}, 5.0, 0.1);
  const Resliced made = reslicer.reslice(surface, {ResliceMode::kLinear, 0.0});
  ASSERT_EQ(made.picture.size(), cv::Size(static_cast<int>(std::lround(10.0 * (bend + (c - b).norm()))), 50));
  ASSERT_EQ(made.covered_share(), 1.0);
  double squares = 0.0;
  for (int y = 0; y < made.picture.rows; ++y) {
    for (int x = 0; x < made.picture.cols; ++x) {
      const double off = made.picture.at<std::uint8_t>(y, x) - pattern(0.1 * x, 1.0 + 0.1 * y);
      squares += off * off;
      ASSERT_LT(std::abs(off), 12.0) << x << " " << y;
    }
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(made.picture.total())), 1.5);
}

// A probe that rides over a cylinder and looks inward: the panorama unrolls it.
TEST(Reslice, PanoramaUnrollsTheWayOfTheProbe) {
  constexpr double kRadius_mm = 40.0;
  constexpr double kMiddle_mm = kRadius_mm - 0.1 * 39.5;  // of the images' middles
  const auto pattern = [](double along, double down) {
    return 128.0 + 100.0 * std::sin(0.6 * along) * std::cos(0.9 * down);
  };
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 120; ++i) {
    // Image y runs to the axis, the images' middle column at x = 3 lies in the plane that is unrolled.
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d::UnitX()));
    pose.translate(Eigen::Vector3d(0.0, -kRadius_mm, 0.0));
    poses.push_back(pose);
  }
  const PlacedScan scan = scan_of(poses, {61, 80}, {0.1, 0.1}, CV_8U, [&](int, const Eigen::Vector3d& at) {
    const double angle = std::atan2(-at.z(), -at.y());
    return pattern(kMiddle_mm * angle, kRadius_mm - std::hypot(at.y(), at.z()));
  });
  const auto frames = placed_frames(*scan.recording, *scan.locator);
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  const Resliced made = reslicer.reslice(panorama_surface(frames, {61, 80}, 30.0, 0.1), {ResliceMode::kLinear, 0.0});
  EXPECT_EQ(made.picture.rows, 80);
  EXPECT_NEAR(made.picture.cols, 1.19 * kMiddle_mm / 0.1, 12.0);  // the last knot may be 1 mm before the end
  EXPECT_GT(made.covered_share(), 0.99);
  for (int y = 0; y < made.picture.rows; ++y) {
    for (int x = 0; x < made.picture.cols; ++x) {
      if (made.covered.at<std::uint8_t>(y, x) == 0) continue;
      ASSERT_NEAR(made.picture.at<std::uint8_t>(y, x), pattern(0.1 * x, 0.1 * y), 4.0) << x << " " << y;
    }
  }
}

TEST(Reslice, PlaneThroughAFrameReachesOverTheSweep) {
  Random random(10);
  const Eigen::Vector2d square(0.3, 0.3);
  const PlacedScan scan = scan_of(trembling_poses(random, kFrames, 1.0, 0.1, 0.02), kSize, square, CV_8U, texture);
  const auto frames = placed_frames(*scan.recording, *scan.locator);
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  // The frame's own plane: its pixels are somewhere in the picture, unchanged.
  const ReslicePlane own = plane_through(frames[9], 0.0, frames, kSize, 0.3);
  const Resliced made = reslicer.reslice(plane_surface(own));
  const Eigen::Vector3d corner_mm = frames[9].reference_from_image.translation() - own.origin_mm;
  const double x = corner_mm.dot(own.x_axis) / 0.3, y = corner_mm.dot(own.y_axis) / 0.3;
  ASSERT_NEAR(x, std::round(x), 1e-9);
  const cv::Rect part(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)), kSize.width, kSize.height);
  EXPECT_TRUE(equal(made.picture(part), scan.recording->image(9)));
  // A quarter turn looks along the sweep: its width is the sweep's length.
  const ReslicePlane across = plane_through(frames[9], 0.5 * std::numbers::pi, frames, kSize, 0.3);
  EXPECT_NEAR(across.size.width * 0.3, 1.0 * (kFrames - 1), 1.0);
  EXPECT_NEAR(across.x_axis.dot(frame_normal(frames[9].reference_from_image)), 1.0, 1e-12);
  const cv::Size size(10, 20);
  const ReslicePlane small = plane_through(frames[9], 0.3, frames, kSize, 0.3, &size);
  EXPECT_EQ(small.size, size);
}

TEST(ResliceSurface, RefusesWhatHasNoPlace) {
  ReslicePlane plane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 4}, 0.5};
  const auto refused = [&](auto change) {
    ReslicePlane other = plane;
    change(other);
    EXPECT_THROW(plane_surface(other), Error);
  };
  refused([](ReslicePlane& p) { p.x_axis.setZero(); });
  refused([](ReslicePlane& p) { p.y_axis = {0.5, 1.0, 0.0}; });
  refused([](ReslicePlane& p) { p.spacing_mm = 0.0; });
  refused([](ReslicePlane& p) { p.size = {1 << 15, 1 << 15}; });
  refused([](ReslicePlane& p) { p.size = {0, 3}; });
  refused([](ReslicePlane& p) { p.origin_mm.x() = std::nan(""); });
  EXPECT_THROW(curved_surface({{0, 0, 0}}, {0, 1, 0}, 5.0, 0.1), Error);
  EXPECT_THROW(curved_surface({{0, 0, 0}, {0, 3, 0}}, {0, 1, 0}, 5.0, 0.1), Error);
  EXPECT_THROW(curved_surface({{0, 0, 0}, {1, 0, 0}}, {0, 0, 0}, 5.0, 0.1), Error);
  EXPECT_THROW(pixels_along(1e9, 1e-3), Error);
}

}  // namespace
}  // namespace fathom
