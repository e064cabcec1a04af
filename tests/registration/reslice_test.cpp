#include "registration/reslice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "tests/real_recordings.h"
#include "tests/registration/scans.h"

namespace fathom {
namespace {

constexpr int kFrames = 24;
const cv::Size kSize{53, 41};
const Eigen::Vector2d kPixel_mm(0.4, 0.3);

Sweep whole(const PlacedScan& scan) { return {0, 0, scan.locator->frame_count() - 1}; }

bool equal(const cv::Mat& a, const cv::Mat& b) {
  if (a.size != b.size || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (!std::equal(a.ptr(y), a.ptr(y) + a.cols * static_cast<int>(a.elemSize()), b.ptr(y))) return false;
  }
  return true;
}

double value(const cv::Mat& image, int x, int y) {
  switch (image.depth()) {
    case CV_8U:
      return image.at<std::uint8_t>(y, x);
    case CV_8S:
      return image.at<std::int8_t>(y, x);
    case CV_16U:
      return image.at<std::uint16_t>(y, x);
    default:
      return image.at<std::int16_t>(y, x);
  }
}

Eigen::Vector3d place(const ResliceSurface& surface, int x, int y) {
  const ResliceRow& row = surface.rows[static_cast<std::size_t>(surface.turned ? x : y)];
  return row.start_mm + (surface.turned ? y : x) * row.step_mm;
}

// Any plane near the middle of the sweep.
ReslicePlane random_plane(Random& random, double sweep_mm, int side = 64) {
  ReslicePlane plane;
  const Eigen::Matrix3d turn = random_pose(random).linear();
  plane.size = {side, side - 7};
  plane.spacing_mm = 0.37;
  plane.x_axis = turn.col(0);
  plane.y_axis = turn.col(1);
  plane.origin_mm = Eigen::Vector3d(10.0, 6.0, 0.5 * sweep_mm) -
                    0.5 * plane.spacing_mm * (plane.size.width * turn.col(0) + plane.size.height * turn.col(1));
  return plane;
}

double texture(int frame, const Eigen::Vector3d& at) {
  return 128.0 + 90.0 * std::sin(0.9 * at.x() + 0.5 * at.z() + frame) * std::cos(1.1 * at.y() - 0.7 * at.z());
}

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

// By the rule, pixel by pixel: the grey value, or nothing for a hole.
std::optional<double> by_hand(const PlacedScan& scan, const std::vector<Sweep>& sweeps,
                              std::optional<std::size_t> only_sweep, const Eigen::Vector3d& point, double half_pixel_mm,
                              const ReslicerOptions& options) {
  struct View {
    double distance_mm;
    bool inside;
    double grey;
  };
  const cv::Rect used = options.clip.value_or(cv::Rect({0, 0}, kSize));
  const auto view = [&](int frame) {
    const Eigen::Affine3d map = scan.map(frame);
    const Eigen::Vector3d normal = map.linear().col(0).cross(map.linear().col(1)).normalized();
    View seen{normal.dot(point - map.translation()), false, 0.0};
    const Eigen::Vector3d px = map.inverse() * (point - seen.distance_mm * normal);
    const auto x = static_cast<int>(std::floor(px.x() + 0.5));
    const auto y = static_cast<int>(std::floor(px.y() + 0.5));
    seen.inside = used.contains({x, y}) && (!options.fan || options.fan->contains(x, y));
    if (seen.inside) seen.grey = value(scan.recording->image(frame), x, y);
    return seen;
  };
  double least = std::numeric_limits<double>::infinity();
  double least_alone = half_pixel_mm;
  std::optional<double> best, alone;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    if (only_sweep && *only_sweep != s) continue;
    for (int f = sweeps[s].first; f <= sweeps[s].last; ++f) {
      const View a = view(f);
      if (a.inside && std::abs(a.distance_mm) < least_alone) {
        least_alone = std::abs(a.distance_mm);
        alone = a.grey;
      }
      if (f == sweeps[s].last) continue;
      const View b = view(f + 1);
      const double sum = std::abs(a.distance_mm) + std::abs(b.distance_mm);
      if ((a.distance_mm < 0.0) == (b.distance_mm < 0.0) || !a.inside || !b.inside) continue;
      if (sum >= least || sum > *options.max_gap_mm) continue;
      least = sum;
      best = std::abs(a.distance_mm) <= std::abs(b.distance_mm) ? a.grey : b.grey;
    }
  }
  return best ? best : alone;
}

// Frames that cross each other, two sweeps, and planes in all directions.
TEST(Reslice, NearestFollowsTheRuleAtEveryPixel) {
  Random random(8);
  int covered = 0, holes = 0;
  for (int trial = 0; trial < 8; ++trial) {
    auto poses = trembling_poses(random, 9, 1.2, 0.5, 0.15);
    for (const Eigen::Isometry3d& pose : trembling_poses(random, 8, 1.3, 0.5, 0.15)) {
      poses.push_back(Eigen::Translation3d(5.0, 2.0, 0.4) *
                      Eigen::AngleAxisd(0.6, Eigen::Vector3d(0.5, 1.0, 0.0).normalized()) * pose);
    }
    const PlacedScan scan = scan_of(poses, kSize, kPixel_mm, CV_8U, texture);
    const std::vector<Sweep> sweeps{{0, 0, 8}, {0, 9, 16}};
    ReslicerOptions options;
    options.max_gap_mm = 2.0;
    if (trial % 2 == 1) options.clip = cv::Rect(4, 3, 41, 33);
    if (trial % 4 > 1) {
      options.fan.emplace();
      options.fan->origin_px = {26, -20};
      options.fan->max_radius_px = 55;
      options.fan->min_radius_px = 22;
      options.fan->min_angle_rad = -0.5;
      options.fan->max_angle_rad = 0.4;
    }
    std::optional<SpacePartition> partition;
    if (trial >= 4) {
      const DividingPlane plane(Eigen::Vector3d(1.0, 0.3, 0.2).normalized(), -9.0);
      partition.emplace(std::vector<SweepShape>{sweep_shape(sweeps[0], *scan.locator, kSize.width, kSize.height),
                                                sweep_shape(sweeps[1], *scan.locator, kSize.width, kSize.height)},
                        std::vector<DividingPlane>{plane});
    }
    const Reslicer reslicer(*scan.recording, *scan.locator, sweeps, options);
    const ResliceSurface surface = plane_surface(random_plane(random, 11.0));
    const Resliced made = reslicer.reslice(surface, {}, partition ? &*partition : nullptr);
    for (int y = 0; y < made.picture.rows; ++y) {
      for (int x = 0; x < made.picture.cols; ++x) {
        const Eigen::Vector3d point = place(surface, x, y);
        const auto sweep = partition ? partition->sweep_at(point) : std::nullopt;
        const auto expected = by_hand(scan, sweeps, sweep, point, 0.5 * surface.spacing_mm, options);
        ASSERT_EQ(made.covered.at<std::uint8_t>(y, x) != 0, expected.has_value()) << trial << ": " << x << " " << y;
        ASSERT_EQ(value(made.picture, x, y), expected.value_or(0.0)) << trial << ": " << x << " " << y;
        ++(expected ? covered : holes);
      }
    }
  }
  EXPECT_GT(covered, 3000);
  EXPECT_GT(holes, 3000);
}

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

TEST(Reslice, ShowsNothingWhereNothingWasRecorded) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 20; ++i) {
    poses.emplace_back(Eigen::Translation3d(0.0, 0.0, 0.5 * i + (i < 10 ? 0.0 : 8.0)));  // 8.5 mm left out
  }
  const PlacedScan scan = scan_of(poses, kSize, kPixel_mm, CV_8U, [](int, const Eigen::Vector3d&) { return 77.0; });
  ReslicePlane plane{{5.0, 5.0, -3.05}, {0, 0, 1}, {0, 1, 0}, {120, 2}, 0.2};
  const auto covered = [&](std::optional<double> max_gap_mm) {
    ReslicerOptions options;
    options.max_gap_mm = max_gap_mm;
    const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)}, options);
    const Resliced made = reslicer.reslice(plane_surface(plane));
    std::vector<double> found_mm;
    for (int x = 0; x < plane.size.width; ++x) {
      const bool here = made.covered.at<std::uint8_t>(0, x) != 0;
      EXPECT_EQ(made.picture.at<std::uint8_t>(0, x), here ? 77 : 0);
      if (here) found_mm.push_back(-3.05 + 0.2 * x);
    }
    return found_mm;
  };
  for (const double z : covered({})) {
    EXPECT_TRUE((z > -0.1 && z < 4.6) || (z > 12.9 && z < 17.6)) << z;
  }
  EXPECT_EQ(covered({}).size(), 2 * 24u);  // pixels from 0.05 mm before 0 mm to 0.05 mm after 4.5 mm
  EXPECT_EQ(covered(8.6).size(), 89u);     // to 0.05 mm after 17.5 mm
  plane.origin_mm.y() = -0.16;             // above the image's first row of pixels, which is 0.3 mm high
  EXPECT_TRUE(covered({}).empty());
}

TEST(Reslice, TakesEveryPixelFromTheSweepOfItsPart) {
  Random random(4);
  auto poses = trembling_poses(random, 12, 0.8, 0.0, 0.0);
  for (const auto& pose : trembling_poses(random, 12, 0.8, 0.0, 0.0))
    poses.push_back(Eigen::Translation3d(8, 0, 0) * pose);
  const PlacedScan scan = scan_of(poses, kSize, kPixel_mm, CV_8U,
                                  [](int frame, const Eigen::Vector3d&) { return frame < 12 ? 50.0 : 200.0; });
  const std::vector<Sweep> sweeps{{0, 0, 11}, {0, 12, 23}};
  std::vector<SweepShape> shapes;
  for (const Sweep& sweep : sweeps) shapes.push_back(sweep_shape(sweep, *scan.locator, kSize.width, kSize.height));
  const SpacePartition partition(shapes, {DividingPlane(Eigen::Vector3d(1.0, 0.4, 0.3).normalized(), -15.0)});
  const Reslicer reslicer(*scan.recording, *scan.locator, sweeps);
  int of_sweep[2] = {0, 0};
  for (int trial = 0; trial < 6; ++trial) {
    const ResliceSurface surface = plane_surface(random_plane(random, 9.0));
    const Resliced made = reslicer.reslice(surface, {}, &partition);
    for (int y = 0; y < made.picture.rows; ++y) {
      for (int x = 0; x < made.picture.cols; ++x) {
        if (made.covered.at<std::uint8_t>(y, x) == 0) continue;
        const std::size_t sweep = *partition.sweep_at(place(surface, x, y));
        ASSERT_EQ(made.picture.at<std::uint8_t>(y, x), sweep == 0 ? 50 : 200);
        ++of_sweep[sweep];
      }
    }
  }
  EXPECT_GT(of_sweep[0], 500);
  EXPECT_GT(of_sweep[1], 500);
}

TEST(Reslice, HasTheSameBytesForAnyNumberOfThreadsAndAnyMemory) {
  Random random(6);
  const PlacedScan scan = scan_of(trembling_poses(random, kFrames, 0.5, 0.3, 0.1), kSize, kPixel_mm, CV_8U, texture);
  const int threads = cv::getNumThreads();
  for (const ResliceMode mode : {ResliceMode::kNearest, ResliceMode::kLinear, ResliceMode::kMean, ResliceMode::kMax}) {
    const ResliceSurface surface = plane_surface(random_plane(random, 12.0));
    const double thickness_mm = mode == ResliceMode::kNearest ? 0.0 : 2.5;
    std::optional<Resliced> first;
    for (const int with_threads : {1, 2, 5}) {
      for (const double bytes : {1.0, 1e9}) {
        cv::setNumThreads(with_threads);
        ReslicerOptions options;
        options.max_frame_bytes = bytes;
        const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)}, options);
        const Resliced made = reslicer.reslice(surface, {mode, thickness_mm});
        if (!first) first = made;
        EXPECT_GT(made.covered_share(), 0.1);
        EXPECT_TRUE(equal(made.picture, first->picture) && equal(made.covered, first->covered));
      }
    }
  }
  cv::setNumThreads(threads);
}

// Says how many of its images are held.
class WatchedRecording : public EditableRecording {
 public:
  using EditableRecording::EditableRecording;
  cv::Mat image(int frame) const override {
    asked.push_back(frame);
    given.push_back(EditableRecording::image(frame).clone());
    int held = 0;
    for (const cv::Mat& image : given) held += image.u->refcount > 1 ? 1 : 0;
    most_held = std::max(most_held, held + 1);
    return given.back();
  }
  mutable std::vector<int> asked;
  mutable std::vector<cv::Mat> given;
  mutable int most_held = 0;
};

TEST(Reslice, HoldsFewFramesAndReadsEachOnceInOrder) {
  Random random(7);
  const PlacedScan scan = scan_of(trembling_poses(random, 200, 0.2, 0.05, 0.01), kSize, kPixel_mm, CV_8U, texture);
  std::vector<cv::Mat> images;
  for (int i = 0; i < 200; ++i) images.push_back(scan.recording->image(i));
  const WatchedRecording watched("watched.mha", scan.recording->header(), images);
  ReslicerOptions options;
  options.max_frame_bytes = 10.0 * kSize.area();
  const Reslicer reslicer(watched, *scan.locator, {whole(scan)}, options);
  const ReslicePlane along{{8.0, 1.0, 38.0}, {0, 0, -1}, {0, 1, 0}, {181, 40}, 0.2};  // against the sweep
  reslicer.reslice(plane_surface(along));
  EXPECT_LE(watched.most_held, 10);
  EXPECT_GT(watched.asked.size(), 175u);
  EXPECT_LT(watched.asked.size(), 190u);  // not those that the picture does not reach
  EXPECT_TRUE(std::is_sorted(watched.asked.begin(), watched.asked.end(), std::less_equal<>()));
}

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

TEST(Reslice, RefusesWhatMakesNoPicture) {
  Random random(1);
  const PlacedScan scan = scan_of(trembling_poses(random, 4, 1.0, 0.1, 0.02), kSize, kPixel_mm, CV_8U, texture);
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  ReslicePlane plane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 4}, 0.5};
  EXPECT_NO_THROW(reslicer.reslice(plane_surface(plane)));
  EXPECT_THROW(reslicer.reslice(plane_surface(plane), {ResliceMode::kMean, -1.0}), Error);
  EXPECT_THROW(reslicer.reslice(plane_surface(plane), {ResliceMode::kMean, 1e9}), Error);
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
  EXPECT_THROW(Reslicer(*scan.recording, *scan.locator, {{0, 0, 4}}), Error);
  ReslicerOptions options;
  options.max_gap_mm = 0.0;
  EXPECT_THROW(Reslicer(*scan.recording, *scan.locator, {whole(scan)}, options), Error);
}

// A calibration whose image axes are not perpendicular, by 3 degrees: pixels are where the calibration says.
TEST(SpineSweep, ComesBackInThePlaneOfEachOfItsFrames) {
  const std::filesystem::path folder = real_recordings();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the recordings of data/plus are not on this machine";
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
