#include "segmentation/outline_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace fathom {
namespace {

std::vector<const Polygon*> pointers(const std::vector<Polygon>& outlines) {
  std::vector<const Polygon*> pointers;
  for (const Polygon& outline : outlines) pointers.push_back(&outline);
  return pointers;
}

std::string fault(const std::vector<Polygon>& outlines) { return outline_fault(pointers(outlines)).value_or(""); }

Polygon box(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

// Wavy enough that no point sees all of it.
Polygon flower(double x, double y, double radius, int points) {
  Polygon outline;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    const double bent = angle + 0.25 * std::sin(5.0 * angle) * std::cos(2.0 * angle);
    const double r = radius * (1.0 + 0.6 * std::sin(5.0 * angle));
    outline.emplace_back(x + r * std::cos(bent), y + r * std::sin(bent));
  }
  return outline;
}

// Does any pair of edges pass through each other, looking at all of them? For outlines in general position.
bool crosses_by_brute_force(const Polygon& outline) {
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x() > 0.0;
  };
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const auto &p = outline[i], &q = outline[i + 1], &r = outline[j], &s = outline[(j + 1) % n];
      if (turn(p, q, r) != turn(p, q, s) && turn(r, s, p) != turn(r, s, q)) return true;
    }
  }
  return false;
}

TEST(OutlineFault, IsFoundExactlyWhereBruteForceFindsIt) {
  Random random(11);
  int crossing = 0;
  for (int round = 0; round < 2000; ++round) {
    const int points = 3 + static_cast<int>(random.uniform(0.0, round % 2 ? 8.0 : 60.0));
    const double unrest = random.uniform(0.0, 0.8);
    Polygon outline;
    for (int i = 0; i < points; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + unrest * random.normal()) / points;
      const double r = 100.0 * (1.0 + 0.5 * unrest * random.normal());
      outline.emplace_back(1000.0 + r * std::cos(angle), 50.0 + r * std::sin(angle));
    }
    const bool expected = crosses_by_brute_force(outline);
    crossing += expected;
    ASSERT_EQ(!fault({outline}).empty(), expected) << "round " << round;
  }
  EXPECT_GT(crossing, 200);
  EXPECT_LT(crossing, 1800);
}

TEST(OutlineFault, NamesThePlaceOfTheCrossing) {
  EXPECT_EQ(fault({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}}), "crosses itself near (5.0, 5.0)");
  EXPECT_EQ(fault({box(0, 0, 10, 10), box(5, -5, 2, 8)}).rfind("crosses another outline near (", 0), 0u);
}

TEST(OutlineFault, IsFoundWhereTheCrossingIsAtACorner) {
  // Through a corner of both, and through a corner that lies on the other's side.
  EXPECT_NE(fault({{{0, 0}, {5, 5}, {10, 10}, {10, 0}, {5, 5}, {0, 10}}}), "");
  EXPECT_NE(fault({{{0, 0}, {10, 10}, {10, 0}, {5, 5}, {0, 10}}}), "");
  EXPECT_NE(fault({box(0, 0, 10, 10), {{5, -5}, {10, 5}, {15, 5}, {5, 20}, {4, 12}}}), "");
}

TEST(OutlineFault, IsNoneWhereOutlinesTouch) {
  // Two loops that meet at a point without passing through each other, in both ways to draw it.
  EXPECT_EQ(fault({{{0, 0}, {5, 5}, {0, 10}, {10, 10}, {5, 5}, {10, 0}}}), "");
  EXPECT_EQ(fault({box(0, 0, 10, 10), box(10, 10, 5, 5)}), "");             // corner to corner
  EXPECT_EQ(fault({box(0, 0, 10, 10), {{10, 5}, {15, 0}, {15, 10}}}), "");  // corner to side
  EXPECT_EQ(fault({box(0, 0, 10, 10), {{0, 5}, {5, 2}, {5, 8}}}), "");      // a hole that reaches the border
  EXPECT_EQ(fault({box(0, 0, 10, 10), box(10, 2, 5, 5)}), "");              // side to side
  EXPECT_EQ(fault({{{0, 0}, {0, 0}, {5, 0}, {5, 0}, {10, 0}, {10, 10}, {0, 0}}}), "");      // points that repeat
  EXPECT_EQ(fault({{{0, 0}, {10, 0}, {10, 5}, {20, 5}, {10, 5}, {10, 10}, {0, 10}}}), "");  // there and back
}

TEST(OutlineFault, IsFoundWhereAnOutlineIsDrawnTwice) {
  Polygon again = flower(50, 50, 30, 100);
  EXPECT_EQ(fault({flower(50, 50, 30, 100), again}), "is drawn twice");
  std::rotate(again.begin(), again.begin() + 17, again.end());
  std::reverse(again.begin(), again.end());
  EXPECT_EQ(fault({flower(50, 50, 30, 100), again}), "is drawn twice");
}

TEST(OutlineFault, GivesUpOnWhatIsTooTangledInsteadOfWorkingForHours) {
  // Long lines at a slant, none of which cross.
  Polygon comb;
  for (int i = 0; i < 40000; ++i) {
    const double x = i * 0.01;
    comb.emplace_back(i % 2 ? x + 1e4 : x, i % 2 ? x * 1e-3 + 1e4 : x * 1e-3);
  }
  comb.emplace_back(5e5, 0.0);
  EXPECT_NE(fault({comb}), "");
}

TEST(OutlineFault, GivesUpOnWhatIsTooCrowdedToo) {
  // Long flat triangles, one above the other, as no organ has.
  std::vector<Polygon> triangles;
  for (int i = 0; i < 15000; ++i) triangles.push_back({{0.0, i + 0.0}, {1e4, i + 0.2}, {0.0, i + 0.5}});
  EXPECT_EQ(fault(triangles), "is too tangled to check");
  triangles.resize(1000);
  EXPECT_EQ(fault(triangles), "");
}

TEST(RequireSimpleOutlines, NamesFileStructureAndFrame) {
  Structure structure;
  structure.name = "bladder";
  structure.contours.resize(2);
  structure.contours[0].frame = structure.contours[1].frame = 12;
  structure.contours[0].points_px = box(0, 0, 10, 10);
  structure.contours[1].points_px = box(2, 2, 3, 3);
  EXPECT_NO_THROW(require_simple_outlines({structure}, "c.json"));
  structure.contours[1].points_px = box(5, 5, 10, 3);
  try {
    require_simple_outlines({structure}, "c.json");
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("c.json: structure bladder, frame 12: an outline crosses another outline near (10.0, ", 0),
              0u)
        << message;
  }
  structure.contours[1].frame = 13;
  EXPECT_NO_THROW(require_simple_outlines({structure}, "c.json"));
}

TEST(Nesting, AlternatesToAnyDepthInAnyOrder) {
  std::vector<Polygon> outlines;
  for (int i : {3, 0, 5, 1, 4, 2}) outlines.push_back(flower(200, 100, 100.0 * std::pow(0.3, i), 200));
  outlines.push_back(box(1000, 0, 5, 5));
  outlines.push_back(box(1001, 1, 1, 1));
  const std::vector<Nesting> expected = {Nesting::kHole, Nesting::kPart, Nesting::kHole, Nesting::kHole,
                                         Nesting::kPart, Nesting::kPart, Nesting::kPart, Nesting::kHole};
  EXPECT_EQ(nesting(pointers(outlines)), expected);
}

TEST(Nesting, IsNotMisledByCornersThatTouch) {
  const Polygon hole = {{0, 5}, {5, 2}, {5, 8}};
  const Polygon beside = {{0, 5}, {-5, 2}, {-5, 8}};
  const Polygon outer = box(0, 0, 10, 10);
  const std::vector<Nesting> expected = {Nesting::kHole, Nesting::kPart, Nesting::kPart};
  EXPECT_EQ(nesting(pointers({hole, beside, outer})), expected);
}

}  // namespace
}  // namespace fathom
