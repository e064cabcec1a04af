#include "measurement/section_shape.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace fathom {
namespace {

Polygon ellipse(double a, double b, double radius_a, double radius_b, int points = 200) {
  Polygon polygon;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    polygon.emplace_back(a + radius_a * std::cos(angle), b + radius_b * std::sin(angle));
  }
  return polygon;
}

// Two parts, one with a hole and a bay that opens to the side.
std::vector<Polygon> awkward() {
  Polygon bay = {{0, 0}, {30, 0}, {30, 4}, {6, 6}, {6, 14}, {30, 16}, {30, 20}, {0, 20}};
  return {bay, {{1, 8}, {4, 8}, {4, 12}, {1, 12}}, ellipse(45.0, 10.0, 5.0, 9.0)};
}

double distance_to(const std::vector<Polygon>& outlines, const Eigen::Vector2d& p) {
  double best = std::numeric_limits<double>::max();
  for (const Polygon& outline : outlines) {
    Eigen::Vector2d from = outline.back();
    for (const Eigen::Vector2d& to : outline) {
      const Eigen::Vector2d along = to - from;
      const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (p - from - t * along).norm());
      from = to;
    }
  }
  return best;
}

bool is_inside(const std::vector<Polygon>& outlines, const Eigen::Vector2d& p) {
  bool in = false;
  for (const Polygon& outline : outlines) {
    Eigen::Vector2d from = outline.back();
    for (const Eigen::Vector2d& to : outline) {
      if ((from.y() > p.y()) != (to.y() > p.y())) {
        in ^= p.x() < from.x() + (to.x() - from.x()) * (p.y() - from.y()) / (to.y() - from.y());
      }
      from = to;
    }
  }
  return in;
}

TEST(SectionShape, DistancesAreThoseToThePolygonsInsideOutsideAndFarOff) {
  const std::vector<Polygon> outlines = awkward();
  const SectionShape shape(outlines, section_raster(outlines, 0.25));
  Random random(1);
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d p(random.uniform(-60.0, 110.0), random.uniform(-60.0, 80.0));
    const double exact = (is_inside(outlines, p) ? 1.0 : -1.0) * distance_to(outlines, p);
    // Bilinear interpolation rounds ridges off by a part of a cell.
    EXPECT_NEAR(shape.distance_mm(p), exact, 0.6 * 0.25) << p.transpose();
  }
}

TEST(SectionShape, TheZeroOfTheDistanceFollowsTheOutlineToSecondOrder) {
  const std::vector<Polygon> circle = {ellipse(0.3, -0.2, 10.0, 10.0, 2000)};
  std::vector<double> errors;
  for (const double cell_mm : {1.0, 0.5, 0.25}) {
    const SectionShape shape(circle, section_raster(circle, cell_mm));
    double worst = 0.0;
    for (const Eigen::Vector2d& point : circle.front()) {
      worst = std::max(worst, std::abs(static_cast<double>(shape.distance_mm(point))));
    }
    errors.push_back(worst);
  }
  EXPECT_LT(errors[0], 0.02);
  EXPECT_LT(errors[1], errors[0] / 3.0);
  EXPECT_LT(errors[2], errors[1] / 3.0);
}

TEST(SectionShape, FarCodesAndDistancesAreThoseOfALargerRaster) {
  const std::vector<Polygon> outlines = awkward();
  const SectionShape small(outlines, section_raster(outlines, 0.5, 2));
  const SectionShape large(outlines, section_raster(outlines, 0.5, 120));
  const SectionRaster& raster = large.raster();
  for (int j = 0; j < raster.rows; j += 3) {
    for (int i = 0; i < raster.columns; i += 3) {
      const Eigen::Vector2d p = raster.origin_mm + raster.cell_mm * Eigen::Vector2d(i, j);
      EXPECT_EQ(small.code(p), large.code(p)) << i << ' ' << j;
      EXPECT_NEAR(small.distance_mm(p), large.distance_mm(p), 0.1 * raster.cell_mm) << i << ' ' << j;
      EXPECT_LE(small.least_outside_mm(p), -std::min(0.0F, small.distance_mm(p)) + 1e-3F);
    }
  }
}

TEST(SectionShape, FieldsAreContinuousAcrossTheRasterRim) {
  const std::vector<Polygon> outlines = awkward();
  const SectionShape shape(outlines, section_raster(outlines, 0.5));
  const SectionRaster& raster = shape.raster();
  const double right = raster.origin_mm.x() + raster.cell_mm * (raster.columns - 1);
  for (double b = -3.0; b < 23.0; b += 0.07) {
    EXPECT_NEAR(shape.code({right - 1e-4, b}), shape.code({right + 1e-4, b}), 0.05);
    EXPECT_NEAR(shape.distance_mm({right - 1e-4, b}), shape.distance_mm({right + 1e-4, b}), 0.05);
  }
}

TEST(SectionShape, CodesAreFiveBesideTheOutlineAndTenACellFartherIn) {
  const std::vector<Polygon> square = {{{0.5, 0.5}, {20.5, 0.5}, {20.5, 20.5}, {0.5, 20.5}}};
  const SectionShape shape(square, section_raster(square, 1.0));
  EXPECT_EQ(shape.code({1.0, 10.0}), 5.0F);
  EXPECT_EQ(shape.code({0.0, 10.0}), -5.0F);
  EXPECT_EQ(shape.code({4.0, 10.0}), 35.0F);
  EXPECT_EQ(shape.code({-6.0, 10.0}), -65.0F);
  EXPECT_EQ(shape.code({-2.0, -2.0}), -(5.0F + 10.0F + 2.0F * 14.0F)) << "diagonally from the corner";
}

TEST(SectionShape, ACircleIsOneDiscAndABayHasDiscsOutside) {
  const std::vector<Polygon> circle = {ellipse(0.0, 0.0, 12.0, 12.0)};
  const SectionShape round(circle, section_raster(circle, 0.5));
  ASSERT_EQ(round.inside_discs().size(), 1U);
  EXPECT_LT(round.inside_discs().front().centre_mm.norm(), 1.1);
  EXPECT_NEAR(round.inside_discs().front().radius, 240.0, 15.0);
  EXPECT_TRUE(round.outside_discs().empty());

  const std::vector<Polygon> outlines = awkward();
  const SectionShape shape(outlines, section_raster(outlines, 0.25));
  bool in_bay = false;
  for (const Disc& disc : shape.outside_discs()) {
    EXPECT_LT(disc.radius, 0.0);
    EXPECT_FALSE(is_inside(outlines, disc.centre_mm));
    in_bay =
        in_bay || (disc.centre_mm.x() > 6.0 && disc.centre_mm.x() < 30.0 && std::abs(disc.centre_mm.y() - 10.0) < 2.0);
  }
  EXPECT_TRUE(in_bay);
  bool in_ellipse = false;
  for (const Disc& disc : shape.inside_discs()) {
    EXPECT_GT(disc.radius, 0.0);
    EXPECT_TRUE(is_inside(outlines, disc.centre_mm));
    in_ellipse = in_ellipse || disc.centre_mm.x() > 40.0;
  }
  EXPECT_TRUE(in_ellipse);
}

TEST(SectionShape, DoesNotDependOnWhereTheOutlineStartsOrItsSense) {
  const std::vector<Polygon> outlines = awkward();
  std::vector<Polygon> turned = outlines;
  for (Polygon& outline : turned) {
    std::rotate(outline.begin(), outline.begin() + 3, outline.end());
    std::reverse(outline.begin(), outline.end());
  }
  const SectionShape one(outlines, section_raster(outlines, 0.4));
  const SectionShape two(turned, section_raster(turned, 0.4));
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d p(random.uniform(-20.0, 70.0), random.uniform(-20.0, 40.0));
    EXPECT_EQ(one.code(p), two.code(p));
    EXPECT_NEAR(one.distance_mm(p), two.distance_mm(p), 0.01);
  }
}

TEST(SectionShape, APointIsAsFarAsItIs) {
  const SectionShape point({3.0, 4.0}, 0.5);
  EXPECT_FLOAT_EQ(point.distance_mm({0.0, 0.0}), -5.0F);
  EXPECT_FLOAT_EQ(point.distance_mm({3.0, 4.0}), 0.0F);
  ASSERT_EQ(point.inside_discs().size(), 1U);
  EXPECT_EQ(point.inside_discs().front().radius, 5.0);
}

TEST(SectionShape, AnOutlineBetweenTheRasterPointsStillHasADisc) {
  const std::vector<Polygon> tiny = {{{0.2, 0.2}, {0.6, 0.2}, {0.4, 0.6}}};
  const SectionShape shape(tiny, section_raster(tiny, 1.0));
  EXPECT_EQ(shape.inside_discs().size(), 1U);
  EXPECT_NEAR(shape.distance_mm({20.4, 0.3}), -20.0, 0.5);
}

TEST(SectionShape, RefusesWhatIsNotFiniteOrTooLargeAndSaysWhichCellFits) {
  const std::vector<Polygon> outlines = {ellipse(0.0, 0.0, 50.0, 50.0)};
  EXPECT_THROW(section_raster({}, 1.0), Error);
  EXPECT_THROW(section_raster(outlines, 0.0), Error);
  EXPECT_THROW(section_raster(std::vector<Polygon>{{{0, 0}, {1, 1}}}, 1.0), Error);
  EXPECT_THROW(section_raster(std::vector<Polygon>{{{0, 0}, {1, std::nan("")}, {2, 2}}}, 1.0), Error);
  EXPECT_THROW(SectionShape(Eigen::Vector2d(std::nan(""), 0.0), 1.0), Error);
  EXPECT_THROW(SectionShape({}, SectionRaster{}), Error);
  EXPECT_THROW(SectionShape(outlines, SectionRaster{{-20.0, -20.0}, 1.0, 40, 40}), Error) << "leaves its raster";
  try {
    section_raster(outlines, 0.01);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("0.044 mm or more"), std::string::npos) << error.what();
  }
  EXPECT_NO_THROW(section_raster(outlines, 0.044));
}

}  // namespace
}  // namespace fathom
