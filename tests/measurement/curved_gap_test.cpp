#include "measurement/curved_gap.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/measurement/parallel_stack.h"

namespace fathom {
namespace {

using stacks::ellipse;
using stacks::ellipsoid;
using stacks::every;
using stacks::kEllipsoidStack;
using stacks::kYStack;
using stacks::Likeness;
using stacks::oblique_tube;
using stacks::Outlines;
using stacks::plane_at;
using stacks::shape_of;
using stacks::Stack;
using stacks::tube_stack;
using stacks::y_tube;

struct Orders {
  Likeness linear;
  Likeness curved;
};

Orders both_orders(const Outlines& object, const Stack& stack) {
  std::vector<SectionGap> gaps;
  for (std::size_t i = 0; i + 1 < stack.places.size(); ++i) {
    const auto placed = [&](double z) { return PlacedSection{plane_at(z), shape_of(object(z), stack.cell_mm)}; };
    const PlacedSection first = gaps.empty() ? placed(stack.places[i]) : gaps.back().second();
    gaps.emplace_back(first, placed(stack.places[i + 1]), Guide::kDiscs);
  }
  double truth = 0.0;
  double found[2] = {0.0, 0.0};
  double common[2] = {0.0, 0.0};
  for (std::size_t g = 0; g < gaps.size(); ++g) {
    const CurvedGap curved(gaps[g], g > 0 ? &gaps[g - 1] : nullptr, g + 1 < gaps.size() ? &gaps[g + 1] : nullptr);
    // Beyond this no bulge changes the sign.
    const float most_added =
        0.25F * std::max(gaps[g].first().shape->largest_inside_mm(), gaps[g].second().shape->largest_inside_mm());
    const double z0 = stack.places[g];
    const double height = stack.places[g + 1] - z0;
    const int layers = std::max(1, static_cast<int>(std::lround(height / stack.step_mm)));
    for (int k = 0; k < layers; ++k) {
      const double u = (k + 0.5) / layers;
      const std::vector<Polygon> outlines = object(z0 + u * height);
      for (double b = stack.low.y(); b < stack.high.y(); b += stack.step_mm) {
        const std::vector<double> edges = stacks::crossings(outlines, b);
        for (double a = stack.low.x(); a < stack.high.x(); a += stack.step_mm) {
          const bool is = (std::lower_bound(edges.begin(), edges.end(), a) - edges.begin()) % 2 != 0;
          const float linear = gaps[g].value_mm({a, b}, u);
          const bool open = std::abs(linear) <= most_added;
          const bool made[2] = {linear >= 0.0F, (open ? curved.value_mm({a, b}, u) : linear) >= 0.0F};
          truth += is ? height / layers : 0.0;
          for (const int order : {0, 1}) {
            found[order] += made[order] ? height / layers : 0.0;
            common[order] += is && made[order] ? height / layers : 0.0;
          }
        }
      }
    }
  }
  const auto likeness = [&](int order) {
    return Likeness{2.0 * common[order] / (truth + found[order]), found[order] / truth - 1.0};
  };
  return {likeness(0), likeness(1)};
}

Stack coarse(Stack stack, double step_mm) {
  stack.step_mm = step_mm;
  return stack;
}

TEST(CurvedGap, HasTheVolumeOfAnEllipsoidToHalfAPercent) {
  const Orders orders = both_orders(ellipsoid, coarse(kEllipsoidStack, 1.0));
  EXPECT_LT(std::abs(orders.linear.volume_error), 0.015);
  EXPECT_LT(std::abs(orders.curved.volume_error), 0.005);
  EXPECT_GT(orders.curved.dice, orders.linear.dice);
}

TEST(CurvedGap, LeavesWhatIsStraightAndWhatBranchesAsItIs) {
  const Orders tube = both_orders(oblique_tube, coarse(tube_stack(8.0), 2.0));
  EXPECT_NEAR(tube.curved.dice, tube.linear.dice, 0.003);
  const Orders branches = both_orders(y_tube, coarse(kYStack, 0.5));
  EXPECT_GE(branches.curved.dice, branches.linear.dice - 0.003);
}

TEST(CurvedGap, PassesThroughItsSectionsAndIsTheSameFromItsOtherEnd) {
  const auto placed = [](double z, double b) {
    return PlacedSection{plane_at(z), shape_of({ellipse(0.2 * z, b, 14.0 - 0.08 * z * z, 9.0 - 0.05 * z * z)}, 0.4)};
  };
  const std::vector<PlacedSection> sections = {placed(-6.0, 0.0), placed(-1.0, 1.0), placed(3.0, 1.5),
                                               placed(8.0, 3.0)};
  const auto gap_of = [&](std::size_t from, std::size_t to) {
    return SectionGap(sections[from], sections[to], Guide::kDiscs);
  };
  const SectionGap ahead[3] = {gap_of(0, 1), gap_of(1, 2), gap_of(2, 3)};
  const SectionGap back[3] = {gap_of(3, 2), gap_of(2, 1), gap_of(1, 0)};
  const CurvedGap forward(ahead[1], &ahead[0], &ahead[2]);
  const CurvedGap backward(back[1], &back[0], &back[2]);
  Random random(5);
  double largest = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d ab(random.uniform(-18.0, 18.0), random.uniform(-14.0, 14.0));
    const double u = random.uniform();
    EXPECT_NEAR(forward.value_mm(ab, u), backward.value_mm(ab, 1.0 - u), 1e-3);
    EXPECT_EQ(forward.value_mm(ab, 0.0), sections[1].shape->distance_mm(ab));
    EXPECT_EQ(forward.value_mm(ab, 1.0), sections[2].shape->distance_mm(ab));
    largest = std::max(largest, std::abs(static_cast<double>(forward.bulge_mm(ab))));
  }
  EXPECT_GT(largest, 0.5);
}

TEST(CurvedGap, WithoutNeighboursIsLinear) {
  const SectionGap gap({plane_at(0.0), shape_of({ellipse(0.0, 0.0, 10.0, 8.0)}, 0.4)},
                       {plane_at(5.0), shape_of({ellipse(3.0, 0.0, 12.0, 8.0)}, 0.4)}, Guide::kDiscs);
  const CurvedGap curved(gap, nullptr, nullptr);
  EXPECT_EQ(curved.value_mm({7.0, 3.0}, 0.4), gap.value_mm({7.0, 3.0}, 0.4));
}

TEST(CurvedGapStudy, DiceAndVolumeOfBothOrders) {
  struct Case {
    const char* name;
    Outlines object;
    Stack stack;
  };
  const auto sphere = [](double radius) {
    return [radius](double z) {
      const double square = radius * radius - z * z;
      return square > 0.0 ? std::vector<Polygon>{ellipse(0.0, 0.0, std::sqrt(square), std::sqrt(square))}
                          : std::vector<Polygon>{};
    };
  };
  std::vector<double> twenty;
  for (int i = 0; i < 20; ++i) twenty.push_back(-20.0 + 40.0 * (i + 0.5) / 20.0);
  const std::vector<Case> cases = {
      {"ellipsoid, every 10 mm", ellipsoid, kEllipsoidStack},
      {"sphere of 36 px, every 8 slices", sphere(36.0), {every(-32.0, 32.0, 8.0), 0.5, {-38, -38}, {38, 38}, 0.5}},
      {"sphere of 20 mm, 20 planes", sphere(20.0), {twenty, 0.25, {-21, -21}, {21, 21}, 0.25}},
      {"oblique tube, every 8 slices", oblique_tube, tube_stack(8.0)},
      {"Y tube, every 10 mm", y_tube, kYStack}};
  std::printf("| object | linear: Dice, volume %% | second order |\n");
  for (const Case& c : cases) {
    const Orders orders = both_orders(c.object, c.stack);
    std::printf("| %s | %.4f, %+.2f | %.4f, %+.2f |\n", c.name, orders.linear.dice, 100.0 * orders.linear.volume_error,
                orders.curved.dice, 100.0 * orders.curved.volume_error);
  }
}

}  // namespace
}  // namespace fathom
