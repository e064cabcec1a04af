#include "measurement/section_gap.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/measurement/parallel_stack.h"

namespace fathom {
namespace {

using stacks::bladder_and_prostate;
using stacks::ducts;
using stacks::ellipse;
using stacks::ellipsoid;
using stacks::every;
using stacks::kEllipsoidStack;
using stacks::kYStack;
using stacks::Likeness;
using stacks::oblique_tube;
using stacks::Outlines;
using stacks::plane_at;
using stacks::reconstruct;
using stacks::shape_of;
using stacks::Stack;
using stacks::tube_stack;
using stacks::y_tube;

constexpr std::array<Guide, 3> kGuides = {Guide::kShape, Guide::kCentroids, Guide::kDiscs};

TEST(SectionGap, DiscsFollowAnObliqueTubeThatShapesLose) {
  EXPECT_GE(reconstruct(oblique_tube, tube_stack(8.0), Guide::kDiscs).dice, 0.99);
  EXPECT_GE(reconstruct(oblique_tube, tube_stack(12.0), Guide::kDiscs).dice, 0.95);
  EXPECT_LT(reconstruct(oblique_tube, tube_stack(8.0), Guide::kShape).dice, 0.8);
  EXPECT_LT(reconstruct(oblique_tube, tube_stack(12.0), Guide::kShape).dice, 0.6);
}

TEST(SectionGap, DiscsKeepAnEllipsoidsVolumeToTheBiasOfLinearInterpolation) {
  EXPECT_LT(std::abs(reconstruct(ellipsoid, kEllipsoidStack, Guide::kDiscs).volume_error), 0.015);
}

TEST(SectionGap, DiscsFollowATubeThatForks) { EXPECT_GE(reconstruct(y_tube, kYStack, Guide::kDiscs).dice, 0.985); }

TEST(SectionGap, ATranslatedDiscCorrespondsByThatTranslation) {
  const auto first = shape_of({ellipse(30.0, 20.0, 9.0, 9.0)}, 0.5);
  const auto second = shape_of({ellipse(34.0, 17.0, 9.0, 9.0)}, 0.5);
  const SectionGap gap({plane_at(0.0), first}, {plane_at(5.0), second}, Guide::kDiscs);
  EXPECT_LT((gap.correspondence_mm({30.0, 20.0}) - Eigen::Vector2d(4.0, -3.0)).norm(), 0.5);
}

TEST(SectionGap, ReadFromItsOtherEndIsTheSameField) {
  const auto first = shape_of(ducts(15.0), 0.4);
  const auto second = shape_of(ducts(25.0), 0.4);
  Random random(8);
  for (const Guide guide : kGuides) {
    const SectionGap forward({plane_at(0.0), first}, {plane_at(4.0), second}, guide);
    const SectionGap backward({plane_at(4.0), second}, {plane_at(0.0), first}, guide);
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector2d ab(random.uniform(0.0, 45.0), random.uniform(-15.0, 25.0));
      const double u = random.uniform();
      EXPECT_NEAR(forward.value_mm(ab, u), backward.value_mm(ab, 1.0 - u), 1e-3);
    }
  }
}

TEST(SectionGap, PassesThroughItsSections) {
  const auto first = shape_of(ducts(15.0), 0.4);
  const auto second = shape_of(ducts(25.0), 0.4);
  Random random(9);
  for (const Guide guide : kGuides) {
    const SectionGap gap({plane_at(0.0), first}, {plane_at(4.0), second}, guide);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d ab(random.uniform(0.0, 45.0), random.uniform(-15.0, 25.0));
      EXPECT_EQ(gap.value_mm(ab, 0.0), first->distance_mm(ab));
      EXPECT_EQ(gap.value_mm(ab, 1.0), second->distance_mm(ab));
    }
  }
}

// The samples of a lattice, which are found by a shorter way where that is certain to do, have the same signs as the
// field everywhere and the same values wherever a neighbour has another sign.
TEST(SectionGap, SamplesAreTheFieldWhereverTheSurfaceIs) {
  const auto first = shape_of(ducts(15.0), 0.4);
  const auto second = shape_of(ducts(25.0), 0.4);
  for (const Guide guide : kGuides) {
    const SectionGap gap({plane_at(0.0), first}, {plane_at(4.0), second}, guide);
    for (const int parity : {0, 1}) {
      ColumnGrid grid;
      grid.start_mm = {-10.0, -25.0};
      grid.column_step_mm = {1.13, 0.0};
      grid.row_step_mm = {0.0, 0.8};
      grid.columns = 60;
      grid.rows = 70;
      grid.parity = parity;
      const GapColumns columns = gap.prepare(grid);
      for (const double u : {0.25, 0.5, 0.75}) {
        std::vector<float> out(grid.size());
        gap.sample(columns, u, out);
        const auto value = [&](int i, int j) {
          return gap.value_mm(grid.row_start_mm(j) + i * grid.column_step_mm, u);
        };
        for (int j = 0; j < grid.rows; ++j) {
          for (int i = 0; i < grid.columns; ++i) {
            const float exact = value(i, j);
            const float sampled = out[static_cast<std::size_t>(j * grid.columns + i)];
            EXPECT_EQ(exact >= 0.0F, sampled >= 0.0F);
            bool beside_surface = false;
            for (int dj = -1; dj <= 1; ++dj) {
              for (int di = -1; di <= 1; ++di) {
                if (i + di < 0 || i + di >= grid.columns || j + dj < 0 || j + dj >= grid.rows) continue;
                beside_surface = beside_surface || (value(i + di, j + dj) >= 0.0F) != (exact >= 0.0F);
              }
            }
            if (beside_surface) {
              EXPECT_NEAR(exact, sampled, 1e-4);
            }
          }
        }
      }
    }
  }
}

// Wherever they lie on the raster.
TEST(SectionGap, TwoNearObjectsMergeByShapeAndNotByDiscs) {
  const auto bridged = [](Guide guide, double aside_mm) {
    const auto placed = [&](double z) {
      std::vector<Polygon> outlines = bladder_and_prostate(z);
      for (Polygon& outline : outlines) {
        for (Eigen::Vector2d& point : outline) point.x() += aside_mm;
      }
      return PlacedSection{plane_at(z), shape_of(outlines, 0.55)};
    };
    int count = 0;
    const SectionGap gap(placed(0.0), placed(10.0), guide);
    for (const double u : {0.25, 0.5, 0.75}) {
      // Along the line between both middles something must be outside.
      const Eigen::Vector2d from(aside_mm - 17.0 * u, 0.0);
      const Eigen::Vector2d to(aside_mm + 35.0 - 17.0 * u, 0.0);
      bool parted = false;
      for (int s = 0; s <= 200; ++s) parted = parted || gap.value_mm(from + s / 200.0 * (to - from), u) < 0.0F;
      count += parted ? 0 : 1;
    }
    return count;
  };
  EXPECT_GT(bridged(Guide::kShape, 0.0), 0);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(bridged(Guide::kDiscs, 80.0 - 0.437 * i), 0) << i;
}

TEST(SectionGap, HolesGoOn) {
  const std::vector<Polygon> ring = {ellipse(0.0, 0.0, 20.0, 15.0), ellipse(2.0, 0.0, 8.0, 6.0)};
  const auto shape = shape_of(ring, 0.5);
  for (const Guide guide : kGuides) {
    const SectionGap gap({plane_at(0.0), shape}, {plane_at(3.0), shape}, guide);
    EXPECT_LT(gap.value_mm({2.0, 0.0}, 0.5), 0.0F);
    EXPECT_GT(gap.value_mm({-13.0, 0.0}, 0.5), 0.0F);
    EXPECT_LT(gap.value_mm({-25.0, 0.0}, 0.5), 0.0F);
  }
}

// A cylinder along the middle of a fan: walls as straight as it has, though the planes turn by 20 degrees.
TEST(SectionGap, ACylinderScannedByAFanKeepsStraightWalls) {
  constexpr double kRadius = 8.0;
  constexpr double kDepth = 40.0;  // from the fan's axis to the cylinder's
  const auto fan_plane = [](double angle) {
    return SectionPlane{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(),
                        Eigen::Vector3d(0.0, std::cos(angle), std::sin(angle))};
  };
  // The plane at an angle cuts the cylinder (along z, axis at y = depth) in an ellipse that is longer along b.
  const auto cut = [&](double angle) {
    return shape_of({ellipse(0.0, kDepth / std::cos(angle), kRadius, kRadius / std::cos(angle))}, 0.25);
  };
  const double half = 10.0 * std::numbers::pi / 180.0;
  for (const Guide guide : {Guide::kDiscs, Guide::kShape}) {
    const SectionGap gap({fan_plane(0.0), cut(0.0)}, {fan_plane(2.0 * half), cut(2.0 * half)}, guide);
    double worst = 0.0;
    for (double b = kDepth - 12.0; b < kDepth + 16.0; b += 0.2) {
      for (const double u : {0.25, 0.5, 0.75}) {
        // On the line from plane to plane through b.
        const Eigen::Vector3d at = (1.0 - u) * fan_plane(0.0).at({0.0, b}) + u * fan_plane(2.0 * half).at({0.0, b});
        const double true_mm = kRadius - std::abs(at.y() - kDepth);
        if (std::abs(true_mm) > 0.8) continue;
        worst = std::max(worst, std::abs(gap.value_mm({0.0, b}, u) - true_mm));
      }
    }
    EXPECT_LT(worst, guide == Guide::kDiscs ? 0.25 : 1.0);
  }
}

TEST(SectionGap, PlanesThatCrossHaveAFieldEverywhereAndASignForEachSide) {
  const SectionPlane first = plane_at(0.0);
  const double tilt = 0.3;
  const SectionPlane second{Eigen::Vector3d(0.0, 0.0, -6.0 * std::sin(tilt)),
                            Eigen::Vector3d(std::cos(tilt), 0.0, std::sin(tilt)), Eigen::Vector3d::UnitY()};
  const auto shape = shape_of({ellipse(6.0, 0.0, 15.0, 10.0)}, 0.5);
  for (const Guide guide : kGuides) {
    const SectionGap gap({first, shape}, {second, shape}, guide);
    for (double a = -20.0; a < 30.0; a += 0.1) {
      for (const double u : {0.0, 0.3, 0.5, 1.0}) EXPECT_TRUE(std::isfinite(gap.value_mm({a, 1.0}, u)));
    }
    EXPECT_EQ(gap.sweep_sign({20.0, 0.0}), 1);
    EXPECT_EQ(gap.sweep_sign({-20.0, 0.0}), -1);
  }
}

TEST(SectionGapStudy, DiceAndVolumeOfTheThreeGuides) {
  struct Case {
    const char* name;
    Outlines object;
    Stack stack;
  };
  const std::vector<Case> cases = {
      {"oblique tube, every 8 slices", oblique_tube, tube_stack(8.0)},
      {"oblique tube, every 12 slices", oblique_tube, tube_stack(12.0)},
      {"ellipsoid, every 10 mm", ellipsoid, kEllipsoidStack},
      {"Y tube, every 10 mm", y_tube, kYStack},
      {"sphere of 36 px, every 8 slices",
       [](double z) {
         const double square = 36.0 * 36.0 - z * z;
         return square > 0.0 ? std::vector<Polygon>{ellipse(0.0, 0.0, std::sqrt(square), std::sqrt(square))}
                             : std::vector<Polygon>{};
       },
       {every(-32.0, 32.0, 8.0), 0.5, {-38.0, -38.0}, {38.0, 38.0}, 0.5}},
      {"bladder beside prostate, 10 mm", bladder_and_prostate, {{0.0, 10.0}, 0.5, {-40, -18}, {50, 18}, 0.5}},
      {"ducts, every 8 mm", ducts, {every(0.0, 40.0, 8.0), 0.25, {-15, -35}, {60, 30}, 0.25}}};
  std::printf("| object | shape-based: Dice, volume %% | centroid-guided | disc-guided |\n");
  for (const Case& c : cases) {
    std::printf("| %s", c.name);
    for (const Guide guide : kGuides) {
      const Likeness likeness = reconstruct(c.object, c.stack, guide);
      std::printf(" | %.4f, %+.2f", likeness.dice, 100.0 * likeness.volume_error);
    }
    std::printf(" |\n");
  }
}

}  // namespace
}  // namespace fathom
