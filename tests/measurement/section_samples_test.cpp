#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "measurement/section_gap.h"
#include "tests/measurement/parallel_stack.h"

// Lattices of samples between two sections, against the field itself.
namespace fathom {
namespace {

using stacks::ellipse;
using stacks::plane_at;
using stacks::shape_of;

constexpr int kLayers = 6;

ColumnGrid grid_of(Lattice lattice, int parity) {
  ColumnGrid grid;
  grid.start_mm = {-30.0, -25.0};
  grid.column_step_mm = {lattice == Lattice::kCubic ? 0.8 : 1.13, 0.0};
  grid.row_step_mm = {0.0, 0.8};
  grid.columns = 70;
  grid.rows = 60;
  grid.lattice = lattice;
  grid.parity = lattice == Lattice::kCubic ? 0 : parity;
  return grid;
}

struct Samples {
  std::vector<std::vector<float>> sampled;
  std::vector<std::vector<float>> exact;
};

Samples samples_of(const SectionGap& gap, Lattice lattice) {
  Samples samples;
  for (int k = 1; k < kLayers; ++k) {
    const ColumnGrid grid = grid_of(lattice, k % 2);
    const double u = static_cast<double>(k) / kLayers;
    samples.sampled.emplace_back(grid.size());
    gap.sample(gap.prepare(grid, 1.0 / kLayers), u, samples.sampled.back());
    std::vector<float> exact;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        exact.push_back(gap.value_mm(grid.row_start_mm(j) + i * grid.column_step_mm, u));
      }
    }
    samples.exact.push_back(exact);
  }
  return samples;
}

// All that a mesher reads is exact: samples with a sample of another sign among those two steps away at most.
void expect_exact_near_surface(const Samples& samples, const ColumnGrid& grid, std::size_t& near) {
  const int layers = static_cast<int>(samples.exact.size());
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * grid.columns + i); };
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const float exact = samples.exact[static_cast<std::size_t>(k)][at(i, j)];
        const float sampled = samples.sampled[static_cast<std::size_t>(k)][at(i, j)];
        ASSERT_EQ(exact >= 0.0F, sampled >= 0.0F) << i << ' ' << j << ' ' << k;
        bool beside = false;
        for (int dk = -2; dk <= 2 && !beside; ++dk) {
          if (k + dk < 0 || k + dk >= layers) continue;
          // Rows of two layers may be displaced against each other by half a step either way.
          const int reach = 2 - std::abs(dk) / 2;
          for (int dj = -reach; dj <= reach; ++dj) {
            for (int di = -reach; di <= reach; ++di) {
              if (i + di < 0 || i + di >= grid.columns || j + dj < 0 || j + dj >= grid.rows) continue;
              if (std::abs(di) + std::abs(dj) + std::abs(dk) > 2) continue;
              const float other = samples.exact[static_cast<std::size_t>(k + dk)][at(i + di, j + dj)];
              beside = beside || (other >= 0.0F) != (exact >= 0.0F);
            }
          }
        }
        if (!beside) continue;
        ++near;
        ASSERT_NEAR(exact, sampled, 1e-4) << i << ' ' << j << ' ' << k;
      }
    }
  }
}

// The second plane turned by `turn_rad` about the line a = `about_mm`, b_mm above it where a = 0.
SectionPlane turned_plane(double turn_rad, double height_mm) {
  return {Eigen::Vector3d(0.0, 0.0, height_mm), Eigen::Vector3d(std::cos(turn_rad), 0.0, std::sin(turn_rad)),
          Eigen::Vector3d::UnitY()};
}

TEST(SectionSamples, AreTheFieldWhereverTheSurfaceIsWhateverTheAngleOfThePlanes) {
  const std::vector<Polygon> two = {ellipse(-8.0, -3.0, 9.0, 12.0), ellipse(14.0, 6.0, 6.0, 5.0)};
  const std::vector<Polygon> one = {ellipse(4.0, 4.0, 18.0, 9.0), ellipse(2.0, 4.0, 4.0, 3.0)};
  const std::vector<Polygon> far_aside = {ellipse(12.0, 6.0, 7.0, 9.0)};
  struct Case {
    std::vector<Polygon> first;
    std::vector<Polygon> second;
    double turn_rad;
    double height_mm;
  };
  const std::vector<Case> cases = {{two, one, 0.0, 5.0}, {two, one, 0.1, 5.0},        {two, one, 0.4, 6.0},
                                   {two, two, 0.5, 1.0}, {one, far_aside, 0.03, 5.0}, {far_aside, two, -0.2, 4.0}};
  for (const Case& c : cases) {
    const PlacedSection first{plane_at(0.0), shape_of(c.first, 0.4)};
    const PlacedSection second{turned_plane(c.turn_rad, c.height_mm), shape_of(c.second, 0.4)};
    for (const Guide guide : {Guide::kDiscs, Guide::kShape}) {
      const SectionGap gap(first, second, guide);
      for (const Lattice lattice : {Lattice::kBodyCentred, Lattice::kCubic}) {
        std::size_t near = 0;
        expect_exact_near_surface(samples_of(gap, lattice), grid_of(lattice, 0), near);
        EXPECT_GT(near, 1000U);
      }
    }
  }
}

TEST(SectionSamples, OfAPointAndOfAnAbsentSectionAreTheField) {
  const PlacedSection outlined{plane_at(0.0), shape_of({ellipse(1.0, -2.0, 11.0, 8.0)}, 0.4)};
  const PlacedSection point{plane_at(5.0), std::make_shared<SectionShape>(Eigen::Vector2d(6.0, 1.0), 0.4)};
  const PlacedSection absent{plane_at(5.0), std::make_shared<SectionShape>()};
  for (const PlacedSection& second : {point, absent}) {
    for (const Guide guide : {Guide::kDiscs, Guide::kShape, Guide::kCentroids}) {
      const SectionGap gap(outlined, second, guide);
      std::size_t near = 0;
      expect_exact_near_surface(samples_of(gap, Lattice::kBodyCentred), grid_of(Lattice::kBodyCentred, 0), near);
      EXPECT_GT(near, 500U);
    }
  }
}

TEST(SectionSamples, MostAreNotFoundAlongTheirOwnLines) {
  const SectionGap gap({plane_at(0.0), shape_of({ellipse(0.0, 0.0, 20.0, 18.0)}, 0.4)},
                       {plane_at(5.0), shape_of({ellipse(2.0, 1.0, 21.0, 17.0)}, 0.4)}, Guide::kDiscs);
  const ColumnGrid grid = grid_of(Lattice::kBodyCentred, 0);
  const std::size_t guided = gap.prepare(grid, 1.0 / kLayers).guided();
  EXPECT_GT(guided, 100U);
  EXPECT_LT(guided, grid.size() / 2);
}

// An absent neighbour ends a structure half-way: the deepest point of a disc of radius 10 is gone there.
TEST(SectionSamples, AnAbsentNeighbourEndsTheStructureHalfWay) {
  const PlacedSection outlined{plane_at(0.0), shape_of({ellipse(0.0, 0.0, 10.0, 10.0)}, 0.25)};
  const PlacedSection absent{plane_at(8.0), std::make_shared<SectionShape>()};
  for (const Guide guide : {Guide::kDiscs, Guide::kShape, Guide::kCentroids}) {
    const SectionGap gap(outlined, absent, guide);
    EXPECT_GT(gap.value_mm({0.0, 0.0}, 0.48), 0.0F);
    EXPECT_LT(gap.value_mm({0.0, 0.0}, 0.52), 0.0F);
    EXPECT_NEAR(gap.value_mm({5.0, 0.0}, 0.25), 0.75 * 5.0 - 0.25 * 10.0, 0.1);
    const SectionGap nothing(absent, absent, guide);
    EXPECT_LT(nothing.value_mm({0.0, 0.0}, 0.5), 0.0F);
  }
}

// A circle that ends in a point over its middle is a cone.
TEST(SectionSamples, ACircleAndAPointOverItsMiddleMakeACone) {
  const PlacedSection circle{plane_at(0.0), shape_of({ellipse(0.0, 0.0, 10.0, 10.0)}, 0.125)};
  const PlacedSection point{plane_at(10.0), std::make_shared<SectionShape>(Eigen::Vector2d::Zero(), 0.125)};
  for (const Guide guide : {Guide::kDiscs, Guide::kShape, Guide::kCentroids}) {
    const SectionGap gap(circle, point, guide);
    for (const double u : {0.2, 0.5, 0.8}) {
      for (double angle = 0.0; angle < 6.0; angle += 0.5) {
        const double radius = 10.0 * (1.0 - u);
        const Eigen::Vector2d on(radius * std::cos(angle), radius * std::sin(angle));
        EXPECT_NEAR(gap.value_mm(on, u), 0.0, 0.13) << static_cast<int>(guide) << ' ' << u;
      }
    }
  }
}

}  // namespace
}  // namespace fathom
