#include "segmentation/refine.h"

#include <vector>

#include <gtest/gtest.h>

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
