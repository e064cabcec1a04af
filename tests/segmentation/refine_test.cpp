#include "segmentation/refine.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "segmentation/best_shifts.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_topology.h"
#include "tests/segmentation/drawn_images.h"

namespace fathom {
namespace {

using Eigen::Vector2d;

const Vector2d kCentre(80.3, 70.6);

cv::Mat disc_image(double outside, double inside, double noise, std::uint64_t seed = 1) {
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(outside));
  draw_disc(clean, kCentre, 40.0, inside);
  return speckled(clean, noise, seed);
}

std::vector<Polygon> refined(const cv::Mat& image, const std::vector<Polygon>& drawn,
                             const RefineOptions& options = {}) {
  const EdgeMap map = edge_map(image, options.edges);
  return refine_outlines(map, drawn, learn_boundary(map, drawn, options), options);
}

bool simple(const std::vector<Polygon>& outlines) { return !outline_fault(outlines); }

TEST(RefineOutlines, MovesToTheBoundaryFromBothSidesInDarkAndInBright) {
  const std::vector<Polygon> right = {circle(kCentre, 40.0, 300)};
  for (const double inside : {60.0, 190.0}) {
    const cv::Mat image = disc_image(125.0, inside, 20.0);
    for (const double radius : {35.0, 46.0}) {
      EXPECT_GT(dice(refined(image, {circle(kCentre + Vector2d(1, -1), radius, 60)}), right), 0.985) << radius;
    }
  }
}

TEST(RefineOutlines, ThreePixelsOffComeNearerThroughCoarseSpeckle) {
  // Grains as large as the error, as strong as the contrast.
  double off = 0.0;
  int outlines = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    cv::Mat clean(240, 320, CV_32F, cv::Scalar(125.0));
    draw_disc(clean, {160.0, 120.0}, 80.0, 100.0);
    cv::Mat noise = speckled(cv::Mat(80, 107, CV_32F, cv::Scalar(125.0)), 20.0, seed);
    cv::resize(noise, noise, clean.size(), 0.0, 0.0, cv::INTER_CUBIC);
    cv::Mat image;
    noise.convertTo(image, CV_32F, 1.0, -125.0);
    image += clean;
    for (const double radius : {77.0, 83.0}) {
      double sum = 0.0;
      const std::vector<Polygon> line = refined(image, {circle({160.0, 120.0}, radius, 250)});
      for (const Vector2d& point : line[0]) sum += std::abs((point - Vector2d(160.0, 120.0)).norm() - 80.0);
      off += sum / static_cast<double>(line[0].size());
      ++outlines;
    }
  }
  EXPECT_LT(off / outlines, 0.67 * 3.0);
}

TEST(RefineOutlines, OtherStructuresAreNotGrownInto) {
  // Drawn side by side, though the edge is 4 pixels inside of the one on the right.
  const cv::Mat image = disc_image(125.0, 60.0, 10.0);
  const std::vector<Polygon> left = {{{50, 40}, {116, 40}, {116, 100}, {50, 100}}};
  const std::vector<Polygon> right = {{{116.3, 40}, {150, 40}, {150, 100}, {116.3, 100}}};
  const EdgeMap map = edge_map(image);
  const EdgePreference boundary = learn_boundary(map, left, {});
  const auto farthest_right = [](const std::vector<Polygon>& outlines) {
    double farthest = 0.0;
    for (const Vector2d& point : outlines[0]) {
      if (point.y() > 50.0 && point.y() < 90.0) farthest = std::max(farthest, point.x());
    }
    return farthest;
  };
  EXPECT_GT(farthest_right(refine_outlines(map, left, boundary, {})), 118.0)
      << "the edge of the disc is to be found there";
  EXPECT_LT(farthest_right(refine_outlines(map, left, boundary, {}, right)), 116.3);
}

TEST(RefineOutlines, OfTwoBoundariesTakesTheOneThatLooksAsTheDrawnOnesShow) {
  // A bright wall of 6 pixels around the dark disc: from dark to bright inside, from bright to dark outside.
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(60.0));
  draw_disc(clean, kCentre, 46.0, 180.0);
  draw_disc(clean, kCentre, 40.0, 60.0);
  const EdgeMap map = edge_map(speckled(clean, 10.0, 1), {1.5});  // fine enough for the wall
  const std::vector<Polygon> between = {circle(kCentre, 43.0, 60)};
  EdgePreference boundary;
  boundary.strength = 10.0;
  for (const int bright_side : {-1, 1}) {
    boundary.bright_side = bright_side;
    const double area = std::abs(signed_area(refine_outlines(map, between, boundary)[0]));
    EXPECT_NEAR(std::sqrt(area / std::numbers::pi), bright_side == -1 ? 40.0 : 46.0, 1.0);
  }
}

TEST(RefineOutlines, HolesGoToTheirOwnBoundary) {
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(125.0));
  draw_disc(clean, kCentre, 45.0, 60.0);
  draw_disc(clean, kCentre, 20.0, 125.0);
  const std::vector<Polygon> drawn = {circle(kCentre, 48.0, 60), circle(kCentre, 16.5, 40)};
  const std::vector<Polygon> ring = refined(speckled(clean, 15.0, 1), drawn);
  const std::vector<Polygon> right = {circle(kCentre, 45.0, 300), circle(kCentre, 20.0, 200)};
  EXPECT_GT(dice(ring, right), 0.97);
  EXPECT_TRUE(simple(ring));
}

TEST(RefineOutlines, StaysWhereThereIsNothingToGoTo) {
  const std::vector<Polygon> drawn = {circle({80, 70}, 20.0, 50)};
  for (const double grey : {0.0, 255.0}) {
    EXPECT_EQ(refined(cv::Mat(140, 160, CV_8U, cv::Scalar(grey)), drawn), drawn);
  }
  // Far from the boundary; speckle alone does not move it much.
  EXPECT_GT(dice(refined(disc_image(125.0, 60.0, 20.0), drawn), drawn), 0.9);
}

TEST(RefineOutlines, NoPointMovesFartherThanTheReach) {
  RefineOptions options;
  for (const double reach : {1.0, 4.0, 20.0}) {
    options.reach_px = reach;
    const auto moved = refined(disc_image(125.0, 60.0, 20.0), {circle(kCentre, 52.0, 200)}, options);
    for (const Vector2d& point : moved[0]) EXPECT_GT((point - kCentre).norm(), 52.0 - reach - 0.3);
  }
}

TEST(RefineOutlines, NeverCrossThemselvesOrEachOther) {
  Random random(3);
  for (int trial = 0; trial < 15; ++trial) {
    // Two drawn outlines that nearly touch, jagged, over speckle and an edge that both want.
    std::vector<Polygon> drawn = {circle({60, 70}, 20.0, 40), circle({103, 70}, 20.0, 40)};
    for (Polygon& outline : drawn) {
      for (Vector2d& point : outline) point += Vector2d(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    }
    if (!simple(drawn)) continue;
    RefineOptions options;
    options.reach_px = 25.0;
    options.stiffness = 0.0;
    EXPECT_TRUE(simple(refined(disc_image(125.0, 60.0, 35.0, static_cast<std::uint64_t>(trial)), drawn, options)))
        << trial;
  }
}

TEST(RefineOutlines, ContoursOfThreePointsAndBeyondTheImageAreTaken) {
  const cv::Mat image = disc_image(125.0, 60.0, 15.0);
  const std::vector<Polygon> triangle = {
      {kCentre + Vector2d(0, -50), kCentre + Vector2d(44, 26), kCentre + Vector2d(-44, 26)}};
  RefineOptions options;
  options.reach_px = 20.0;
  const std::vector<Polygon> disc = {circle(kCentre, 40.0, 300)};
  EXPECT_GT(dice(refined(image, triangle, options), disc), dice(triangle, disc));
  const std::vector<Polygon> tiny = {{{5.0, 5.0}, {5.1, 5.0}, {5.0, 5.1}}};
  EXPECT_TRUE(simple(refined(image, tiny)));
  const std::vector<Polygon> outside = {circle({-300.0, 900.0}, 30.0, 20)};
  EXPECT_GT(dice(refined(image, outside), outside), 0.97);
  EXPECT_TRUE(refined(image, {}).empty());
}

TEST(RefineOutlines, KeepsThePlaceBesideTheEdgeWhereAsked) {
  const cv::Mat image = disc_image(125.0, 60.0, 10.0);
  RefineOptions options;
  options.edges.scale_px = 1.5;
  options.keep_place = true;
  const std::vector<Polygon> drawn = {circle(kCentre, 42.0, 200)};
  EXPECT_NEAR(std::sqrt(std::abs(signed_area(refined(image, drawn, options)[0])) / std::numbers::pi), 42.0, 0.4);
  options.keep_place = false;
  EXPECT_NEAR(std::sqrt(std::abs(signed_area(refined(image, drawn, options)[0])) / std::numbers::pi), 40.0, 0.5);
}

TEST(BestShifts, AreTheCheapestOfAllWays) {
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    ShiftCosts costs(6, 2);
    for (std::size_t i = 0; i < 6; ++i) {
      for (int s = -2; s <= 2; ++s) costs.at(i, s) = random.uniform();
    }
    const double bend = 0.1;
    const auto total = [&](const std::vector<int>& shifts) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) {
        const int d = shifts[(i + 1) % 6] - shifts[i];
        if (std::abs(d) > kMostDifference) return 1e9;
        sum += costs.at(i, shifts[i]) + bend * d * d;
      }
      return sum;
    };
    double least = 1e9;
    for (int code = 0; code < 15625; ++code) {
      std::vector<int> shifts;
      for (int i = 0, rest = code; i < 6; ++i, rest /= 5) shifts.push_back(rest % 5 - 2);
      least = std::min(least, total(shifts));
    }
    EXPECT_NEAR(total(best_shifts(costs, bend)), least, 1e-12);
  }
}

}  // namespace
}  // namespace fathom
