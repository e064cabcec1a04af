#include "segmentation/outline_editing.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_topology.h"
#include "tests/segmentation/drawn_images.h"

namespace fathom {
namespace {

using Eigen::Vector2d;
using Outlines = std::vector<Polygon>;

bool simple(const Outlines& outlines) { return !outline_fault(outlines); }

// Of what outlines enclose by even-odd.
double area_of(const Outlines& outlines) {
  const std::vector<Nesting> places = nesting(outlines);
  double area = 0.0;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    area += (places[i] == Nesting::kHole ? -1.0 : 1.0) * std::abs(signed_area(outlines[i]));
  }
  return area;
}

double distance_to(const Vector2d& point, const Polygon& outline) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const double share = std::clamp((point - outline[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (point - outline[i] - share * edge).norm());
  }
  return nearest;
}

constexpr double kPi = std::numbers::pi;

TEST(Brush, ADabOnNothingIsADiscOfItsRadius) {
  const Outlines dab = brushed({}, {{{30.2, 40.7}}, 6.3, false});
  ASSERT_EQ(dab.size(), 1u);
  EXPECT_NEAR(area_of(dab), kPi * 6.3 * 6.3, 0.01 * kPi * 6.3 * 6.3);
  for (const Vector2d& point : dab[0]) EXPECT_NEAR((point - Vector2d(30.2, 40.7)).norm(), 6.3, 0.06);
  const Outlines line = brushed({}, {{{0, 0}, {40, 0}}, 5.0, false});
  EXPECT_NEAR(area_of(line), kPi * 25.0 + 400.0, 3.0);
  EXPECT_TRUE(brushed({}, {{{30, 40}}, 6.0, true}).empty());
}

TEST(Brush, AddsAndTakesAwayTheUnionAndDifferenceOfAreas) {
  const Outlines square = {{{0, 0}, {60, 0}, {60, 60}, {0, 60}}};
  const double half_disc = 0.5 * kPi * 100.0;
  EXPECT_NEAR(area_of(brushed(square, {{{60, 30}}, 10.0, false})), 3600.0 + half_disc, 3.0);
  EXPECT_NEAR(area_of(brushed(square, {{{60, 30}}, 10.0, true})), 3600.0 - half_disc, 3.0);
  // Cut in two; the cut is 10 wide.
  const Outlines halves = brushed(square, {{{30, -20}, {30, 80}}, 5.0, true});
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_NEAR(area_of(halves), 3000.0, 4.0);
}

TEST(Brush, AnErasedMiddleIsAHoleAndFillingItGivesTheOldOutlineBack) {
  const Outlines disc = {circle({50, 50}, 30.0, 200)};
  const Outlines ring = brushed(disc, {{{50, 50}}, 10.0, true});
  ASSERT_EQ(ring.size(), 2u);
  EXPECT_EQ(ring[0], disc[0]) << "not touched";
  EXPECT_NEAR(area_of(ring), area_of(disc) - kPi * 100.0, 2.0);
  // An island in the hole, then the hole filled.
  const Outlines island = brushed(ring, {{{50, 50}}, 3.0, false});
  ASSERT_EQ(island.size(), 3u);
  EXPECT_NEAR(area_of(island), area_of(ring) + kPi * 9.0, 1.0);
  EXPECT_EQ(brushed(island, {{{50, 50}}, 12.0, false}), disc);
}

TEST(Brush, WhatIsNotTouchedStaysAndTouchedOutlinesStayInPlaceAwayFromTheStroke) {
  Outlines now = {circle({50, 50}, 30.0, 200), circle({150, 50}, 20.0, 100)};
  const Polygon first = now[0];
  const Polygon other = now[1];
  for (int i = 0; i < 30; ++i) now = brushed(now, {{{80, 50.0 + 0.1 * i}}, 4.0, i % 2 == 0});
  EXPECT_NE(std::find(now.begin(), now.end(), other), now.end());
  for (const Polygon& outline : now) {
    for (const Vector2d& point : outline) {
      if (point.x() < 70.0) {
        EXPECT_LT(distance_to(point, first), 1e-6);
      }
    }
  }
  EXPECT_TRUE(simple(now));
}

TEST(Brush, RandomScribblesKeepOutlinesSimpleAndMatchPixels) {
  Random random(9);
  Outlines now = {circle({60, 60}, 30.0, 100)};
  cv::Mat right = outline_mask(now, {0, 0, 120, 120}, 2);
  for (int i = 0; i < 30; ++i) {
    BrushStroke stroke{{}, random.uniform(3.0, 12.0), random.uniform() < 0.5};
    for (int k = 0; k < 3; ++k) stroke.line_px.emplace_back(random.uniform(20, 100), random.uniform(20, 100));
    now = brushed(now, stroke);
    ASSERT_TRUE(simple(now)) << i;
    const Outlines alone = brushed({}, {stroke.line_px, stroke.radius_px, false});
    const cv::Mat covered = outline_mask(alone, {0, 0, 120, 120}, 2);
    right.setTo(stroke.erase ? 0 : 255, covered);
    const cv::Mat made = outline_mask(now, {0, 0, 120, 120}, 2);
    EXPECT_LT(cv::countNonZero(made != right), 0.02 * cv::countNonZero(right | made) + 40) << i;
  }
}

TEST(Brush, RefusesStrokesThatAreNone) {
  EXPECT_THROW(brushed({}, {{}, 5.0, false}), Error);
  EXPECT_THROW(brushed({}, {{{0, 0}}, 0.1, false}), Error);
  EXPECT_THROW(brushed({}, {{{0, std::numeric_limits<double>::quiet_NaN()}}, 5.0, false}), Error);
  EXPECT_THROW(brushed({}, {{{0, 0}, {1e8, 1e8}}, 5.0, false}), Error);
}

TEST(Grown, ADiscsRadiusChangesByTheDistance) {
  const Outlines disc = {circle({50.3, 50.1}, 30.0, 300)};
  for (const double by : {-12.0, -1.0, 3.0, 15.0}) {
    EXPECT_NEAR(std::sqrt(area_of(grown(disc, by)) / kPi), 30.0 + by, 0.05) << by;
  }
  EXPECT_TRUE(grown(disc, -31.0).empty());
  EXPECT_EQ(grown(disc, 0.0), disc);
  EXPECT_THROW(grown(disc, 1e9), Error);
}

TEST(Cleaned, OpeningDropsSpikesAndSpecksClosingFillsGaps) {
  const Outlines body = {circle({60, 60}, 30.0, 200)};
  Outlines spiked = brushed(body, {{{60, 60}, {110, 60}}, 2.0, false});  // a spike
  spiked.push_back(circle({20, 100}, 2.5, 20));                          // a speck
  CleanOptions options;
  options.open_px = 4.0;
  const Outlines opened = cleaned(spiked, options);
  ASSERT_EQ(opened.size(), 1u);
  EXPECT_GT(dice(opened, body), 0.995);
  options = {};
  options.close_px = 4.0;
  const Outlines slit = brushed(body, {{{60, 60}, {110, 60}}, 2.0, true});
  EXPECT_GT(dice(cleaned(slit, options), body), 0.995);
  EXPECT_LT(dice(slit, body), 0.98);
}

TEST(Cleaned, SmallPartsAndHolesGoByTheirArea) {
  const Outlines all = {circle({60, 60}, 40.0, 200), circle({60, 60}, 5.0, 50), circle({60, 60}, 2.0, 30),
                        circle({150, 60}, 6.0, 50)};
  CleanOptions options;
  options.fill_holes_px = 100.0;
  EXPECT_EQ(cleaned(all, options), (Outlines{all[0], all[3]})) << "with the hole goes the island in it";
  options = {};
  options.min_part_px = 120.0;
  EXPECT_EQ(cleaned(all, options), (Outlines{all[0], all[1]}));
  EXPECT_EQ(cleaned(all, {}), all);
  options.open_px = -1.0;
  EXPECT_THROW(cleaned(all, options), Error);
}

TEST(EvenedOut, RoughnessGoesAndAreaStays) {
  Random random(2);
  Polygon rough = circle({100, 100}, 40.0, 250);
  for (Vector2d& point : rough) point += 0.8 * Vector2d(random.uniform(-1, 1), random.uniform(-1, 1));
  const auto roughness = [](const Polygon& outline) {
    double most = 0.0;
    for (const Vector2d& point : outline) most = std::max(most, std::abs((point - Vector2d(100, 100)).norm() - 40.0));
    return most;
  };
  Polygon hole = circle({100, 100}, 15.0, 90);
  std::reverse(hole.begin(), hole.end());
  for (const double width : {1.0, 4.0, 15.0}) {
    const Outlines even = evened_out(Outlines{rough, hole}, width);
    ASSERT_EQ(even.size(), 2u);
    EXPECT_NEAR(signed_area(even[0]), signed_area(rough), 1e-5 * kPi * 1600.0);
    EXPECT_NEAR(signed_area(even[1]), signed_area(hole), 1e-5 * kPi * 225.0);
    EXPECT_LT(roughness(even[0]), (width > 2.0 ? 0.4 : 0.9) * roughness(rough));
    EXPECT_TRUE(simple(even));
  }
  EXPECT_EQ(evened_out(Outlines{hole}, 0.0), Outlines{hole});
  EXPECT_THROW(evened_out(Outlines{hole}, -1.0), Error);
}

TEST(EvenedOut, OutlinesThatNearlyTouchDoNotCross) {
  // A thin crescent inside of another outline, and a triangle.
  const Outlines near = {circle({50, 50}, 30.0, 100), circle({50, 50}, 29.6, 100), {{0, 0}, {4, 0}, {0, 4}}};
  const Outlines even = evened_out(near, 20.0);
  EXPECT_TRUE(simple(even));
  EXPECT_EQ(even.size(), 3u);
}

}  // namespace
}  // namespace fathom
