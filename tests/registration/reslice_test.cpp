#include "registration/reslice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "tests/registration/pictures.h"

namespace fathom {
namespace {

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

TEST(Reslice, RefusesWhatMakesNoPicture) {
  Random random(1);
  const PlacedScan scan = scan_of(trembling_poses(random, 4, 1.0, 0.1, 0.02), kSize, kPixel_mm, CV_8U, texture);
  const Reslicer reslicer(*scan.recording, *scan.locator, {whole(scan)});
  const ResliceSurface surface = plane_surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 4}, 0.5});
  EXPECT_NO_THROW(reslicer.reslice(surface));
  EXPECT_THROW(reslicer.reslice(surface, {ResliceMode::kMean, -1.0}), Error);
  EXPECT_THROW(reslicer.reslice(surface, {ResliceMode::kMean, 1e9}), Error);
  EXPECT_THROW(Reslicer(*scan.recording, *scan.locator, {{0, 0, 4}}), Error);
  ReslicerOptions options;
  options.max_gap_mm = 0.0;
  EXPECT_THROW(Reslicer(*scan.recording, *scan.locator, {whole(scan)}, options), Error);
}

}  // namespace
}  // namespace fathom
