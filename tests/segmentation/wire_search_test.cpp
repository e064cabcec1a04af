#include "segmentation/wire_search.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "core/random.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_topology.h"

namespace fathom {
namespace {

WireCosts random_costs(cv::Size size, std::uint64_t seed) {
  WireCosts costs{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.area()) * kWireSteps)};
  Random random(seed);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (std::size_t i = 0; i < kWireSteps; ++i) {
        const bool leads_out = !cv::Rect({}, size).contains({x + kWireStepX[i], y + kWireStepY[i]});
        costs.steps[static_cast<std::size_t>(y * size.width + x) * kWireSteps + i] =
            leads_out ? std::uint8_t{0} : static_cast<std::uint8_t>(random.uniform(1.0, 256.0));
      }
    }
  }
  return costs;
}

int cost_of(const WireCosts& costs, const std::vector<cv::Point>& path) {
  int sum = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const cv::Point by = path[i + 1] - path[i];
    std::size_t step = 0;
    while (step < kWireSteps && (kWireStepX[step] != by.x || kWireStepY[step] != by.y)) ++step;
    if (step == kWireSteps) return -1;
    sum += costs.steps[static_cast<std::size_t>(path[i].y * costs.size.width + path[i].x) * kWireSteps + step];
  }
  return sum;
}

// Costs from one pixel to all, by relaxing until nothing changes (Bellman and Ford).
std::vector<int> all_costs(const WireCosts& costs, cv::Point from) {
  const int width = costs.size.width;
  std::vector<int> to(static_cast<std::size_t>(costs.size.area()), std::numeric_limits<int>::max() / 2);
  to[static_cast<std::size_t>(from.y * width + from.x)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t p = 0; p < to.size(); ++p) {
      for (std::size_t i = 0; i < kWireSteps; ++i) {
        const int step = costs.steps[p * kWireSteps + i];
        if (step == 0) continue;
        const auto q = static_cast<std::size_t>(static_cast<int>(p) + kWireStepY[i] * width + kWireStepX[i]);
        if (to[p] + step >= to[q]) continue;
        to[q] = to[p] + step;
        changed = true;
      }
    }
  }
  return to;
}

TEST(WireSearch, PathsAreTheCheapestThereAreInWhateverOrderTheyAreAskedFor) {
  const WireCosts costs = random_costs({17, 13}, 3);
  const cv::Point from(5, 7);
  const std::vector<int> right = all_costs(costs, from);
  WireSearch search(costs);
  search.start(from, {});
  for (const int pixel : {220, 0, 100, 16, 124, 219, 130}) {
    const cv::Point to(pixel % 17, pixel / 17);
    const std::vector<cv::Point> path = search.path_to(to);
    EXPECT_EQ(path.front(), from);
    EXPECT_EQ(path.back(), to);
    EXPECT_EQ(cost_of(costs, path), right[static_cast<std::size_t>(pixel)]);
  }
}

TEST(WireSearch, SpreadsOnlyAsFarAsAsked) {
  WireCosts costs = random_costs({101, 101}, 3);
  for (std::uint8_t& step : costs.steps) step = step == 0 ? 0 : 10;
  WireSearch search(costs);
  search.start({50, 50}, {});
  search.path_to({55, 50});
  const int near = search.settled();
  EXPECT_LT(near, 15 * 15);
  search.path_to({53, 51});
  EXPECT_EQ(search.settled(), near) << "has been reached before";
}

TEST(WireSearch, GoesAroundWhatIsOccupied) {
  WireCosts costs = random_costs({41, 41}, 3);
  for (std::uint8_t& step : costs.steps) step = step == 0 ? 0 : 10;
  std::vector<cv::Point> wall;
  for (int y = 5; y <= 35; ++y) wall.emplace_back(20, y);
  WireSearch search(costs);
  search.start({10, 20}, wall);
  for (const cv::Point& pixel : search.path_to({30, 20})) {
    EXPECT_EQ(std::find(wall.begin(), wall.end(), pixel), wall.end());
  }
}

TEST(OutlineLoops, TheLargerPartStaysWhereAnOutlineCrossesItself) {
  const Polygon eight = {{0, 0}, {10, 10}, {10, 0}, {0, 10}, {-20, 5}};
  const Polygon kept = without_loops(eight);
  const std::vector<const Polygon*> one = {&kept};
  EXPECT_EQ(outline_fault(one), std::nullopt);
  EXPECT_DOUBLE_EQ(std::abs(signed_area(kept)), 0.5 * 10 * 20 + 0.5 * 10 * 5);
  const Polygon square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(without_loops(square), square);
  EXPECT_DOUBLE_EQ(signed_area(square), 1.0);
}

TEST(OutlineLoops, OfRandomTanglesSomethingSimpleStays) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Polygon tangle;
    for (int i = 0; i < 15; ++i) tangle.emplace_back(random.uniform(0, 100), random.uniform(0, 100));
    const Polygon kept = without_loops(tangle);
    ASSERT_GE(kept.size(), 3u);
    const std::vector<const Polygon*> one = {&kept};
    EXPECT_EQ(outline_fault(one), std::nullopt) << trial;
    EXPECT_GT(std::abs(signed_area(kept)), 1.0);
  }
}

TEST(OutlineMask, HolesAreLeftOutAndPixelsCountByTheirCentres) {
  const std::vector<Polygon> ring = {{{0, 0}, {9, 0}, {9, 9}, {0, 9}},
                                     {{2.5, 2.5}, {5.5, 2.5}, {5.5, 5.5}, {2.5, 5.5}}};
  const cv::Mat mask = outline_mask(ring, {-2, -2, 14, 14});
  int inside = 0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      EXPECT_EQ(mask.at<std::uint8_t>(y, x) != 0, encloses(ring, {x - 2.0, y - 2.0}));
      inside += mask.at<std::uint8_t>(y, x) != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(inside, 9 * 9 - 3 * 3);  // the upper and left borders count, the lower and right ones do not
}

TEST(Dice, IsTwiceTheCommonAreaOverBoth) {
  const std::vector<Polygon> a = {{{0, 0}, {10, 0}, {10, 10}, {0, 10}}};
  const std::vector<Polygon> b = {{{5, 0}, {15, 0}, {15, 10}, {5, 10}}};
  EXPECT_NEAR(dice(a, b), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(dice(a, a), 1.0);
  EXPECT_DOUBLE_EQ(dice(a, std::vector<Polygon>{}), 0.0);
  EXPECT_DOUBLE_EQ(dice(std::vector<Polygon>{}, std::vector<Polygon>{}), 1.0);
}

}  // namespace
}  // namespace fathom
