#include "registration/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "registration/fill_holes.h"
#include "tests/real_recordings.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 47;

cv::Mat random_image(Random& random, int type) {
  cv::Mat image(kHeight, kWidth, type);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (type == CV_8U) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.uniform(0, 256));
      if (type == CV_16S) image.at<std::int16_t>(y, x) = static_cast<std::int16_t>(random.uniform(-32768, 32768));
    }
  }
  return image;
}

// Frames that turn and move about one place, in pixels of 0.2 x 0.3 mm.
std::vector<PlacedImage> random_frames(int count, int type) {
  Random random(5);
  std::vector<PlacedImage> frames;
  for (int i = 0; i < count; ++i) {
    PlacedImage frame{random_image(random, type), Eigen::Affine3d::Identity()};
    const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    frame.reference_from_image.linear() = Eigen::AngleAxisd(random.uniform(-3, 3), axis).toRotationMatrix() *
                                          Eigen::Vector3d(0.2, 0.3, 0.25).asDiagonal();
    frame.reference_from_image.translation() = Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    frames.push_back(frame);
  }
  return frames;
}

VoxelGrid grid_for(const std::vector<PlacedImage>& frames, double spacing_mm) {
  std::vector<PlacedFrame> placed;
  for (const PlacedImage& frame : frames) placed.push_back({0, frame.reference_from_image});
  return grid_around(placed, {kWidth, kHeight}, {}, spacing_mm);
}

double voxel(const Reconstructed& volume, const Eigen::Vector3i& at) {
  const cv::Mat& voxels = volume.volume.voxels;
  return voxels.type() == CV_8U ? voxels.at<std::uint8_t>(at[2], at[1], at[0])
                                : voxels.at<std::int16_t>(at[2], at[1], at[0]);
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size == b.size && a.type() == b.type() && std::equal(a.data, a.data + a.total() * a.elemSize(), b.data);
}

class ReconstructionOfFrames : public testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(ReconstructionOfFrames, NearestIsTheExactMeanLatestMeanAndMaximumOfThePixelsInEachVoxel) {
  const auto [spacing_mm, type] = GetParam();
  const auto frames = random_frames(12, type);
  const VoxelGrid grid = grid_for(frames, spacing_mm);
  std::vector<std::vector<std::pair<int, double>>> pixels(static_cast<std::size_t>(grid.voxels()));
  const auto index = [&grid](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::size_t>((z * grid.size[1] + y) * grid.size[0] + x);
  };
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Eigen::Vector3d at =
            grid.reference_from_voxel().inverse() * (frames[f].reference_from_image * Eigen::Vector3d(x, y, 0));
        const Eigen::Vector3d cell = (at.array() + 0.5).floor();
        if ((cell.array() < 0).any()) continue;
        const auto cx = static_cast<std::int64_t>(cell.x());
        const auto cy = static_cast<std::int64_t>(cell.y());
        const auto cz = static_cast<std::int64_t>(cell.z());
        if (cx >= grid.size[0] || cy >= grid.size[1] || cz >= grid.size[2]) continue;
        const double value =
            type == CV_8U ? frames[f].image.at<std::uint8_t>(y, x) : frames[f].image.at<std::int16_t>(y, x);
        pixels[index(cx, cy, cz)].emplace_back(static_cast<int>(f), value);
      }
    }
  }
  for (const Compounding compounding : {Compounding::kMean, Compounding::kLatest, Compounding::kMax}) {
    ReconstructOptions options;
    options.compounding = compounding;
    Reconstruction reconstruction(grid, type, {kWidth, kHeight}, options);
    reconstruction.insert(frames);
    const Reconstructed made = reconstruction.result();
    for (int z = 0; z < grid.size[2]; ++z) {
      for (int y = 0; y < grid.size[1]; ++y) {
        for (int x = 0; x < grid.size[0]; ++x) {
          const auto& here = pixels[index(x, y, z)];
          ASSERT_EQ(made.filled.at<std::uint8_t>(z, y, x), here.empty() ? 0 : 255);
          if (here.empty()) continue;
          double sum = 0.0, count = 0.0, largest = -1e9;
          for (const auto& [frame, value] : here) {
            if (compounding == Compounding::kLatest && frame != here.back().first) continue;
            sum += value;
            count += 1.0;
            largest = std::max(largest, value);
          }
          const double expected = compounding == Compounding::kMax ? largest : std::floor(sum / count + 0.5);
          ASSERT_EQ(voxel(made, {x, y, z}), expected) << x << " " << y << " " << z;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Spacings, ReconstructionOfFrames,
                         testing::Combine(testing::Values(0.25, 0.5, 1.3), testing::Values(CV_8U, CV_16S)));

TEST(Reconstruction, LinearIsTheMeanByTrilinearWeights) {
  const auto frames = random_frames(8, CV_8U);
  for (const double spacing_mm : {0.25, 0.9}) {  // pixels farther apart than voxels, and nearer
    const VoxelGrid grid = grid_for(frames, spacing_mm);
    const Eigen::Vector3i size(static_cast<int>(grid.size[0]), static_cast<int>(grid.size[1]),
                               static_cast<int>(grid.size[2]));
    const int sizes[3] = {size.z(), size.y(), size.x()};
    cv::Mat sum = cv::Mat::zeros(3, sizes, CV_64F);
    cv::Mat weight = cv::Mat::zeros(3, sizes, CV_64F);
    for (const PlacedImage& frame : frames) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Eigen::Vector3d at =
              grid.reference_from_voxel().inverse() * (frame.reference_from_image * Eigen::Vector3d(x, y, 0));
          for (int corner = 0; corner < 8; ++corner) {
            const Eigen::Vector3i cell =
                at.array().floor().cast<int>() + Eigen::Array3i(corner & 1, corner >> 1 & 1, corner >> 2);
            if ((cell.array() < 0).any() || (cell.array() >= size.array()).any()) continue;
            const double share = (1.0 - (at - cell.cast<double>()).array().abs()).prod();
            weight.at<double>(cell.z(), cell.y(), cell.x()) += share;
            sum.at<double>(cell.z(), cell.y(), cell.x()) += share * frame.image.at<std::uint8_t>(y, x);
          }
        }
      }
    }
    ReconstructOptions options;
    options.insertion = Insertion::kLinear;
    Reconstruction reconstruction(grid, CV_8U, {kWidth, kHeight}, options);
    reconstruction.insert(frames);
    const Reconstructed made = reconstruction.result();
    int compared = 0;
    for (int z = 0; z < size.z(); ++z) {
      for (int y = 0; y < size.y(); ++y) {
        for (int x = 0; x < size.x(); ++x) {
          const double total = weight.at<double>(z, y, x);
          ASSERT_EQ(made.filled.at<std::uint8_t>(z, y, x) != 0, total > 0.0 && made.filled.at<std::uint8_t>(z, y, x));
          if (total < 0.1) continue;  // of smaller weights, steps of 1/256 are a large part
          ASSERT_NE(made.filled.at<std::uint8_t>(z, y, x), 0);
          ASSERT_NEAR(voxel(made, {x, y, z}), sum.at<double>(z, y, x) / total, 4.0) << x << " " << y << " " << z;
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 1000);
  }
}

TEST(Reconstruction, HasTheSameBytesForAnyNumberOfThreadsAndAnyGrouping) {
  const auto frames = random_frames(20, CV_8U);
  const VoxelGrid grid = grid_for(frames, 0.6);
  const int threads = cv::getNumThreads();
  for (const Insertion insertion : {Insertion::kNearest, Insertion::kLinear}) {
    for (const Compounding compounding : {Compounding::kMean, Compounding::kLatest, Compounding::kMax}) {
      ReconstructOptions options;
      options.insertion = insertion;
      options.compounding = compounding;
      cv::setNumThreads(1);
      Reconstruction at_once(grid, CV_8U, {kWidth, kHeight}, options);
      at_once.insert(frames);
      const Reconstructed expected = at_once.result();
      cv::setNumThreads(5);
      Reconstruction live(grid, CV_8U, {kWidth, kHeight}, options);
      Reconstructed kept = live.result();
      for (const PlacedImage& frame : frames) {
        live.insert({&frame, 1});
        live.update(kept);
      }
      EXPECT_TRUE(equal(kept.volume.voxels, expected.volume.voxels));
      EXPECT_TRUE(equal(kept.filled, expected.filled));
    }
  }
  cv::setNumThreads(threads);
}

TEST(Reconstruction, UsesOnlyWhatTheRectangleAndTheFanLeave) {
  auto frames = random_frames(1, CV_8U);
  frames[0].image = 100;
  frames[0].reference_from_image = Eigen::Affine3d::Identity();
  ReconstructOptions options;
  options.clip = cv::Rect(10, 5, 30, 40);
  Fan fan;
  fan.origin_px = {30, -10};
  fan.min_radius_px = 20;
  fan.max_radius_px = 45;
  fan.min_angle_rad = -0.5;
  fan.max_angle_rad = 0.3;
  options.fan = fan;
  Reconstruction reconstruction(grid_for(frames, 1.0), CV_8U, {kWidth, kHeight}, options);
  reconstruction.insert(frames);
  const Reconstructed made = reconstruction.result();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool used = x >= 10 && x < 40 && y >= 5 && y < 45 && fan.contains(x, y);
      ASSERT_EQ(made.filled.at<std::uint8_t>(0, y, x) != 0, used) << x << " " << y;
    }
  }
}

TEST(Reconstruction, RefusesWhatDoesNotFitAndNamesASpacingThatDoes) {
  const auto frames = random_frames(3, CV_8U);
  ReconstructOptions options;
  options.max_bytes = 1e6;
  try {
    Reconstruction(grid_for(frames, 0.02), CV_8U, {kWidth, kHeight}, options);
    FAIL() << "accepted";
  } catch (const Error& error) {
    const std::string what = error.what();
    const auto at = what.find("a spacing of ");
    ASSERT_NE(at, std::string::npos) << what;
    const double fits = std::stod(what.substr(at + 13));
    EXPECT_NO_THROW(Reconstruction(grid_for(frames, fits), CV_8U, {kWidth, kHeight}, options)) << what;
    EXPECT_THROW(Reconstruction(grid_for(frames, 0.9 * fits), CV_8U, {kWidth, kHeight}, options), Error);
  }
}

// By its definition, voxel by voxel.
double filled_by_hand(const cv::Mat& voxels, const cv::Mat& filled, int x, int y, int z, int max_gap) {
  int best = (max_gap + 1) * (max_gap + 1) + 1;
  double sum = 0.0;
  int lines = 0;
  const auto has = [&](int a, int b, int c) {
    return a >= 0 && b >= 0 && c >= 0 && a < filled.size[2] && b < filled.size[1] && c < filled.size[0] &&
           filled.at<std::uint8_t>(c, b, a) != 0;
  };
  for (int d = 0; d < 13; ++d) {  // half of the 26 neighbours
    const int dx = d % 3 - 1, dy = d / 3 % 3 - 1, dz = d / 9 - 1;
    int back = 1, ahead = 1;
    while (back <= max_gap && !has(x - back * dx, y - back * dy, z - back * dz)) ++back;
    while (ahead <= max_gap && !has(x + ahead * dx, y + ahead * dy, z + ahead * dz)) ++ahead;
    if (back > max_gap || ahead > max_gap) continue;
    const int length = (back + ahead) * (back + ahead) * (dx * dx + dy * dy + dz * dz);
    if (length > best || length > (max_gap + 1) * (max_gap + 1)) continue;
    if (length < best) sum = lines = 0;
    best = length;
    const double low = voxels.at<std::uint8_t>(z - back * dz, y - back * dy, x - back * dx);
    const double high = voxels.at<std::uint8_t>(z + ahead * dz, y + ahead * dy, x + ahead * dx);
    sum += low + (high - low) * back / (back + ahead);
    ++lines;
  }
  return lines == 0 ? -1.0 : sum / lines;
}

TEST(FillHoles, BridgesGapsByTheShortestLineAndNothingElse) {
  Random random(3);
  const int sizes[3] = {21, 19, 150};
  cv::Mat voxels = cv::Mat::zeros(3, sizes, CV_8U);
  cv::Mat filled = cv::Mat::zeros(3, sizes, CV_8U);
  for (std::size_t i = 0; i < voxels.total(); ++i) {
    if (random.uniform(0, 1) > 0.01) continue;
    voxels.data[i] = static_cast<std::uint8_t>(random.uniform(0, 256));
    filled.data[i] = 255;
  }
  const cv::Mat before = voxels.clone();
  const cv::Mat marks = filled.clone();
  const std::int64_t count = fill_holes(voxels, filled);
  std::int64_t found = 0;
  for (int z = 0; z < sizes[0]; ++z) {
    for (int y = 0; y < sizes[1]; ++y) {
      for (int x = 0; x < sizes[2]; ++x) {
        if (marks.at<std::uint8_t>(z, y, x) != 0) {
          ASSERT_EQ(voxels.at<std::uint8_t>(z, y, x), before.at<std::uint8_t>(z, y, x));
          continue;
        }
        const double expected = filled_by_hand(before, marks, x, y, z, 9);
        ASSERT_EQ(filled.at<std::uint8_t>(z, y, x) != 0, expected >= 0.0) << x << " " << y << " " << z;
        if (expected < 0.0) continue;
        ++found;
        ASSERT_NEAR(voxels.at<std::uint8_t>(z, y, x), expected, 0.501) << x << " " << y << " " << z;
      }
    }
  }
  EXPECT_EQ(count, found);
  EXPECT_GT(found, 1000);
}

TEST(SpineSweep, LiesOnTheGridOfPlus) {
  const std::filesystem::path folder = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const auto recording = open_recording(folder / "SpinePhantomFreehand.igs.mha");
  const FrameLocator locator(*recording,
                             read_calibration(folder / "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"));
  ReconstructOptions options;
  options.spacing_mm = 0.5;
  const Reconstructed made = reconstruct(*recording, locator, options);
  // The rule, worked out again from the poses.
  Eigen::AlignedBox3d box;
  for (int f = 0; f < recording->header().frame_count(); ++f) {
    const auto map = locator.reference_from_image(f);
    if (!map) continue;
    for (const double x : {0.0, 819.0}) {
      for (const double y : {0.0, 615.0}) box.extend(*map * Eigen::Vector3d(x, y, 0));
    }
  }
  EXPECT_TRUE(made.volume.reference_from_voxel.translation().isApprox(box.min(), 1e-12));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(made.volume.voxels.size[2 - axis], std::lround(box.sizes()[axis] / 0.5) + 1);
  }
}

}  // namespace
}  // namespace fathom
