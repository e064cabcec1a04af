#include "segmentation/live_wire.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_topology.h"
#include "tests/segmentation/drawn_images.h"

namespace fathom {
namespace {

using Eigen::Vector2d;

const Vector2d kCentre(80.3, 70.6);
constexpr double kRadius = 45.0;

cv::Mat disc_image(double noise, std::uint64_t seed = 1) {
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, kCentre, kRadius, 60.0);
  return speckled(clean, noise, seed);
}

void outline_disc(LiveWire& wire, int seeds) {
  for (const Vector2d& seed : circle(kCentre, kRadius, seeds)) wire.add_seed(seed);
  wire.close();
}

double farthest_from_circle(const Polygon& line) {
  double farthest = 0.0;
  for (const Vector2d& point : line) farthest = std::max(farthest, std::abs((point - kCentre).norm() - kRadius));
  return farthest;
}

TEST(LiveWire, FollowsAnEdgeBetweenThePixels) {
  LiveWire wire(disc_image(0.0));
  outline_disc(wire, 3);
  EXPECT_LT(farthest_from_circle(wire.line()), 0.15);
  EXPECT_NEAR(std::abs(signed_area(wire.line())), std::numbers::pi * kRadius * kRadius, 15.0);
}

TEST(LiveWire, FollowsAnEdgeThroughSpeckle) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    LiveWire wire(disc_image(25.0, seed));
    outline_disc(wire, 4);
    EXPECT_GT(dice(std::vector<Polygon>{wire.line()}, std::vector<Polygon>{circle(kCentre, kRadius, 400)}), 0.97);
  }
}

TEST(LiveWire, GoesRoundWhereNothingIsSeenOfTheOutline) {
  // Over 60 pixels of the circle, of which the chord passes 10 pixels inside, the border fades into the speckle.
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, kCentre, kRadius, 60.0);
  cv::Mat faded;
  cv::GaussianBlur(clean, faded, {}, 15.0);
  cv::Mat mask = cv::Mat::zeros(clean.size(), CV_8U);
  const std::vector<cv::Point> sector = {{80, 71}, {155, 36}, {155, 106}};
  cv::fillConvexPoly(mask, sector, cv::Scalar(255));
  faded.copyTo(clean, mask);
  LiveWire wire(speckled(clean, 25.0, 1));
  for (const double angle : {1.2, 3.1, 5.0}) {
    wire.add_seed(kCentre + kRadius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  wire.close();
  EXPECT_LT(farthest_from_circle(wire.line()), 5.0) << "half as far as the chord, at most";
}

TEST(LiveWire, LargeImagesAreSearchedCoarselyAndStillFollowedFinely) {
  cv::Mat clean(600, 800, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, {400.2, 300.7}, 200.0, 60.0);
  LiveWire wire(speckled(clean, 0.0, 1));
  for (const Vector2d& seed : circle({400.2, 300.7}, 200.0, 4)) wire.add_seed(seed);
  wire.close();
  for (const Vector2d& point : wire.line()) EXPECT_NEAR((point - Vector2d(400.2, 300.7)).norm(), 200.0, 0.3);
}

TEST(LiveWire, SeedsBesideTheEdgeTeachWhereTheOutlineLies) {
  // Whoever draws two pixels outside of the steepest place means that line.
  LiveWire wire(disc_image(0.0));
  for (const Vector2d& seed : circle(kCentre, kRadius + 2.0, 4)) wire.add_seed(seed);
  wire.close();
  EXPECT_NEAR(std::sqrt(std::abs(signed_area(wire.line())) / std::numbers::pi), kRadius + 1.5, 0.5);
  LiveWireOptions untrained;
  untrained.train = false;
  LiveWire edge(disc_image(0.0), untrained);
  for (const Vector2d& seed : circle(kCentre, kRadius + 2.0, 4)) edge.add_seed(seed);
  edge.close();
  EXPECT_NEAR(std::sqrt(std::abs(signed_area(edge.line())) / std::numbers::pi), kRadius + 0.2, 0.3);
}

TEST(LiveWire, WhereStructuresTouchItKeepsToTheSideThatWasDrawn) {
  // A brighter disc touches the dark one: there the edge doubles its strength, and another leaves it.
  cv::Mat clean(140, 200, CV_32F, cv::Scalar(120.0));
  draw_disc(clean, {145.0, 70.0}, 25.0, 200.0);
  draw_disc(clean, {80.0, 70.0}, 45.0, 60.0);
  LiveWire wire(speckled(clean, 8.0, 1));
  for (const Vector2d& seed : circle({80.0, 70.0}, 45.0, 5)) wire.add_seed(seed);
  wire.close();
  EXPECT_GT(dice(std::vector<Polygon>{wire.line()}, std::vector<Polygon>{circle({80.0, 70.0}, 45.0, 400)}), 0.98);
}

TEST(LiveWire, UndoTakesBackOneChangeAtATimeAndLeavesTheRest) {
  LiveWire wire(disc_image(10.0));
  std::vector<Polygon> lines = {wire.line()};
  for (const Vector2d& seed : circle(kCentre, kRadius, 4)) {
    wire.add_seed(seed);
    lines.push_back(wire.line());
  }
  wire.close();
  EXPECT_TRUE(wire.closed());
  EXPECT_TRUE(wire.wire_to({3, 3}).empty());
  for (std::size_t i = lines.size(); i-- > 1;) {
    ASSERT_TRUE(wire.undo());
    EXPECT_EQ(wire.line(), lines[i]);
    EXPECT_FALSE(wire.closed());
  }
  EXPECT_TRUE(wire.undo());
  EXPECT_TRUE(wire.line().empty());
  EXPECT_FALSE(wire.undo());
}

TEST(LiveWire, ReseedingGoesOnFromAnEarlierPlaceOnTheLine) {
  LiveWire wire(disc_image(10.0));
  const Polygon seeds = circle(kCentre, kRadius, 4);
  for (const Vector2d& seed : seeds) wire.add_seed(seed);
  const Polygon before = wire.line();
  EXPECT_FALSE(wire.reseed(kCentre, 10.0));
  EXPECT_FALSE(wire.reseed(seeds.back(), 1.0)) << "that is where the line ends already";
  const Vector2d early = kCentre + kRadius * Vector2d(std::cos(0.8), std::sin(0.8));
  ASSERT_TRUE(wire.reseed(early, 3.0));
  ASSERT_EQ(wire.seeds().size(), 2u);
  EXPECT_LT((wire.seeds().back() - early).norm(), 3.0);
  const Polygon kept = wire.line();
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), before.begin()));
  EXPECT_GT((wire.wire_to(seeds[2]).size()), 20u);
  ASSERT_TRUE(wire.undo());
  EXPECT_EQ(wire.line(), before);
  wire.close();
  ASSERT_TRUE(wire.reseed(early, 3.0)) << "a closed line is opened";
  EXPECT_FALSE(wire.closed());
  EXPECT_EQ(wire.line(), kept);
}

TEST(LiveWire, TheSamePointerGivesTheSameWireWhateverWasAskedBefore) {
  LiveWire one(disc_image(20.0));
  LiveWire other(disc_image(20.0));
  one.add_seed({80, 25});
  other.add_seed({80, 25});
  for (int x = 0; x < 160; x += 40) one.wire_to({static_cast<double>(x), 139.0});
  EXPECT_EQ(one.wire_to({125, 70}), other.wire_to({125, 70}));
}

TEST(LiveWire, OutlinesNeverCrossThemselves) {
  Random random(7);
  for (int trial = 0; trial < 12; ++trial) {
    LiveWire wire(disc_image(30.0, static_cast<std::uint64_t>(trial)));
    for (int i = 0; i < 5; ++i) wire.add_seed({random.uniform(0.0, 159.0), random.uniform(0.0, 139.0)});
    try {
      wire.close();
    } catch (const Error&) {
      continue;  // encloses nothing
    }
    const Polygon line = wire.line();
    const std::vector<const Polygon*> one = {&line};
    EXPECT_EQ(outline_fault(one), std::nullopt) << trial;
  }
}

TEST(LiveWire, ImagesWithoutEdgesGiveStraightLines) {
  for (const double grey : {0.0, 255.0}) {
    LiveWire wire(cv::Mat(50, 60, CV_8U, cv::Scalar(grey)));
    wire.add_seed({10, 10});
    EXPECT_EQ(wire.wire_to({50, 20}), (Polygon{{10, 10}, {50, 20}}));
  }
  LiveWire pixel(cv::Mat(1, 1, CV_8U, cv::Scalar(7)));
  pixel.add_seed({0.0, 0.0});
  EXPECT_THROW(pixel.close(), Error);
}

TEST(LiveWire, SaturatedImagesOfManyKindsAreFollowed) {
  cv::Mat clean(140, 160, CV_32F, cv::Scalar(900.0));
  draw_disc(clean, kCentre, kRadius, -900.0);  // black and white, clipped
  for (const int type : {CV_8U, CV_16U, CV_32F}) {
    cv::Mat image;
    speckled(clean, 0.0, 1).convertTo(image, type);
    LiveWire wire(image);
    outline_disc(wire, 3);
    EXPECT_LT(farthest_from_circle(wire.line()), 1.0);
  }
}

TEST(LiveWire, RefusesWhatIsNoImageAndNoSeed) {
  EXPECT_THROW(LiveWire(cv::Mat()), Error);
  EXPECT_THROW(LiveWire(cv::Mat(9, 9, CV_8UC2, cv::Scalar(0))), Error);
  EXPECT_THROW(LiveWire(cv::Mat(9, 9, CV_32F, cv::Scalar(std::numeric_limits<double>::quiet_NaN()))), Error);
  LiveWire wire(disc_image(10.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector2d& seed : {Vector2d(-0.6, 5), Vector2d(159.6, 5), Vector2d(5, 140), Vector2d(nan, 5)}) {
    EXPECT_THROW(wire.add_seed(seed), Error);
  }
  EXPECT_TRUE(wire.wire_to({5, 5}).empty());
  wire.add_seed({159.4, 5});
  EXPECT_THROW(wire.add_seed({159.4, 5.1}), Error);
  EXPECT_THROW(wire.close(), Error);
  EXPECT_EQ(wire.wire_to({1e9, -1e9}).back(), Vector2d(159.5, -0.5)) << "a pointer may leave the image";
}

TEST(LiveWire, SnapsToTheNearestStrongEdge) {
  LiveWire wire(disc_image(0.0));
  const Vector2d near = wire.snapped(kCentre + Vector2d(kRadius + 3.0, 0.0), 6.0);
  EXPECT_NEAR((near - kCentre).norm(), kRadius, 0.8);
  EXPECT_EQ(wire.snapped(kCentre, 6.0), kCentre) << "no edge within reach";
}

}  // namespace
}  // namespace fathom
