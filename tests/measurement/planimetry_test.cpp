#include "measurement/planimetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/measurement/sections.h"

namespace fathom {
namespace {

using namespace sections;

// Linear, cubic, cubic in 3D.
std::array<double, 3> volumes(const Sections& sections) {
  return {linear_planimetry_ml(sections), cubic_planimetry_ml(sections), cubic_planimetry_3d_ml(sections)};
}

void expect_same(const Sections& a, const Sections& b, double relative) {
  const auto of_a = volumes(a);
  const auto of_b = volumes(b);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(of_a[k], of_b[k], relative * of_a[k]) << "method " << k;
}

// A measurement without volumes, and `word` among the reasons.
void expect_nothing_measured(const Sections& sections, const std::string& word) {
  const VolumeMeasurement measurement = measure_planimetry(sections);
  EXPECT_EQ(measurement.sections, static_cast<int>(sections.size()));
  EXPECT_FALSE(measurement.volumes.linear_ml || measurement.volumes.cubic_ml || measurement.volumes.cubic_3d_ml);
  ASSERT_EQ(measurement.warnings.size(), 1u);
  EXPECT_NE(measurement.warnings[0].find(word), std::string::npos) << measurement.warnings[0];
}

// No volume by any method, and `word` among the reasons.
void expect_no_volume(const Sections& sections, const std::string& word) {
  EXPECT_THROW(linear_planimetry_ml(sections), Error);
  EXPECT_THROW(cubic_planimetry_ml(sections), Error);
  EXPECT_THROW(cubic_planimetry_3d_ml(sections), Error);
  expect_nothing_measured(sections, word);
}

// A sphere swept with everything at once: planes in a fan and turning, unsteady, at uneven steps.
Sections unsteady(Random& random, int count) {
  Sections sections;
  for (int i = 0; i < count; ++i) {
    const double u = std::pow(std::max(0.0, i + 0.5 * (random.uniform() - 0.5)) / (count - 1), 1.2) * 1.8 - 0.9;
    const Eigen::Vector3d tilt(0.4 * u + random.uniform(-0.1, 0.1), 0.3 * u * u + random.uniform(-0.1, 0.1), 1.0);
    sections.push_back(sphere_section(3 * i, 20.0, tilt.normalized(), 19.0 * u));
  }
  return sections;
}

// The largest relative error among 4 to 20 planes from `count` on, by method.
std::array<double, 3> worst_from(int count, Sections (*sweep)(double, int)) {
  std::array<double, 3> worst = {};
  for (; count <= 20; ++count) {
    const auto measured = volumes(sweep(10.0, count));
    for (std::size_t k = 0; k < 3; ++k) {
      worst[k] = std::max(worst[k], std::abs(measured[k] / sphere_ml(10.0) - 1.0));
    }
  }
  return worst;
}

TEST(LinearPlanimetry, IsExactForAParaboloidCutByParallelPlanes) {
  // x^2 + y^2 <= 3 z, from the apex to z = 40, in uneven steps and by oblique planes' equal: area pi 3 z.
  Sections sections;
  for (const double z : {0.0, 0.7, 5.0, 6.0, 19.0, 33.3, 40.0}) {
    sections.push_back(section(0, {0.0, 0.0, 1.0}, std::numbers::pi * 3.0 * z, {0.0, 0.0, z}));
  }
  EXPECT_NEAR(linear_planimetry_ml(sections), std::numbers::pi * 1.5 * 40.0 * 40.0 / 1000.0, 1e-12);
}

TEST(Planimetry, IsExactForAPrismByAllMethods) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    // Parallel planes at a slant to the prism, in uneven steps: length times the area square to it.
    const Eigen::Vector3d axis = random_direction(random);
    Eigen::Vector3d normal = random_direction(random);
    if (normal.dot(axis) < 0.0) normal = -normal;
    if (normal.dot(axis) < 0.1) continue;
    Sections sections;
    double along = 0.0;
    for (int i = 0; i < 2 + round % 9; ++i) {
      sections.push_back(section(i, normal, 550.0 / normal.dot(axis), 300.0 * normal + along * axis));
      along += random.uniform(0.2, 9.0);
    }
    const double length = (sections.back().centroid_mm - sections.front().centroid_mm).norm();
    for (const double volume : volumes(sections)) EXPECT_NEAR(volume, 0.55 * length, 1e-11 * length) << round;
  }
}

TEST(Planimetry, IsTheTrapezoidForTwoSections) {
  Sections sections = {section(4, {0.0, 0.1, 1.0}, 300.0, {0.0, 0.0, 0.0}),
                       section(9, {0.2, 0.0, 1.0}, 100.0, {1.0, 2.0, 12.0})};
  const Eigen::Vector3d sum = sections[0].vector_area_mm2 + sections[1].vector_area_mm2;
  for (const double volume : volumes(sections)) {
    EXPECT_NEAR(volume, 0.5 * sum.dot(Eigen::Vector3d(1.0, 2.0, 12.0)) / 1000.0, 1e-12);
  }
  EXPECT_NEAR(cubic_planimetry_ml(sections, SplineEnd::kContinue), volumes(sections)[0], 1e-12);
  const VolumeMeasurement measurement = measure_planimetry(sections);
  EXPECT_TRUE(measurement.volumes.cubic_ml);
  ASSERT_EQ(measurement.warnings.size(), 1u);
  EXPECT_NE(measurement.warnings[0].find("frames 4 and 9"), std::string::npos);
}

TEST(Planimetry, NeedsNoMorePlanesForASphereThanPublished) {
  // Treece 2000, table 2.1, first row: 11, 6 and 6 parallel planes for an error below 1 %. Linear planimetry's error
  // is 1 / (N - 1)^2, which is 1 % at 11.
  EXPECT_LT(worst_from(11, sphere_linear)[0], 0.01 + 1e-12);
  EXPECT_GT(worst_from(10, sphere_linear)[0], 0.012);
  EXPECT_LT(worst_from(6, sphere_linear)[1], 0.01);
  EXPECT_LT(worst_from(6, sphere_linear)[2], 0.01);
  EXPECT_GT(worst_from(5, sphere_linear)[1], 0.01);
}

TEST(Planimetry, NeedsNoMorePlanesForASphereInAFanOrFreeSweepThanPublished) {
  // The same table's second and third rows, with the geometry that gives their linear errors: -1.4 % and -0.9 %.
  const auto fan = [](double radius, int count) { return sphere_fan(radius, 1.02, count); };
  const auto free = [](double radius, int count) {
    return sphere_free(radius, 41.0 / 180.0 * std::numbers::pi, count);
  };
  EXPECT_NEAR(linear_planimetry_ml(fan(10.0, 20)) / sphere_ml(10.0) - 1.0, -0.0141, 0.0001);
  EXPECT_LT(worst_from(9, fan)[1], 0.01);
  EXPECT_LT(worst_from(10, fan)[2], 0.01);
  EXPECT_LT(worst_from(9, free)[1], 0.01);
  EXPECT_LT(worst_from(9, free)[2], 0.01);
}

TEST(CubicPlanimetry, ThatContinuesTheCurvatureIsExactForASphereCutByParallelPlanes) {
  for (const int count : {3, 4, 7, 20}) {
    const Sections sections = sphere_linear(10.0, count);
    EXPECT_NEAR(cubic_planimetry_ml(sections, SplineEnd::kContinue), sphere_ml(10.0), 1e-12);
    EXPECT_NEAR(cubic_planimetry_3d_ml(sections, SplineEnd::kContinue), sphere_ml(10.0), 1e-12);
  }
}

TEST(Planimetry, ConvergesWithTheSquareOfTheSpacingAndCubicWithItsCube) {
  const auto error = [](int count) {
    auto measured = volumes(sphere_linear(10.0, count));
    for (double& volume : measured) volume = std::abs(volume / sphere_ml(10.0) - 1.0);
    return measured;
  };
  const auto coarse = error(41);
  const auto fine = error(81);  // half the spacing
  EXPECT_NEAR(std::log2(coarse[0] / fine[0]), 2.0, 0.05);
  // Catmull-Rom is of third order at the ends, where it does not know the curvature.
  EXPECT_NEAR(std::log2(coarse[1] / fine[1]), 3.0, 0.1);
  EXPECT_NEAR(std::log2(coarse[2] / fine[2]), 3.0, 0.1);
}

TEST(Planimetry, DoesNotChangeWhenTheWholeScanIsTurnedAndMovedByTenMetres) {
  Random random(7);
  for (int round = 0; round < 100; ++round) {
    const Sections sections = round % 3 == 0   ? sphere_fan(15.0, 1.02, 5 + round % 7)
                              : round % 3 == 1 ? sphere_free(15.0, 0.7, 5 + round % 7)
                                               : unsteady(random, 20);
    expect_same(sections, moved(sections, random_motion(random, 10.0)), 1e-9);
  }
}

TEST(Planimetry, DoesNotDependOnTheEndThatTheSweepStartsFrom) {
  Random random(8);
  for (int round = 0; round < 200; ++round) {
    const Sections sections = round % 3 == 0   ? sphere_fan(15.0, 1.02, 5 + round % 7)
                              : round % 3 == 1 ? sphere_free(15.0, 0.7, 5 + round % 7)
                                               : unsteady(random, 4 + round % 30);
    expect_same(sections, reversed(sections), 1e-12);
  }
}

TEST(Planimetry, DoesNotDependOnTheSideThatTheProbeLooksFrom) {
  // The probe turned about its own axis by half a turn: every normal points the other way.
  Random random(9);
  Sections turned = unsteady(random, 20);
  const Sections sections = turned;
  for (CrossSection& section : turned) {
    section.normal = -section.normal;
    section.vector_area_mm2 = -section.vector_area_mm2;
  }
  expect_same(sections, turned, 1e-12);
}

TEST(CubicPlanimetry, DoesNotDependOnTheScaleOfAreaAgainstLength) {
  // Treece 2000, section 2.2.3: the planar representation may be stretched one way if it is shrunk the other.
  Random random(10);
  const Sections sections = unsteady(random, 20);
  for (const double scale : {1e-3, 0.3, 7.0, 1e4}) {
    Sections scaled = sections;
    for (CrossSection& section : scaled) {
      section.vector_area_mm2 *= scale;
      section.centroid_mm /= scale;
    }
    EXPECT_NEAR(cubic_planimetry_ml(scaled), cubic_planimetry_ml(sections), 1e-12 * cubic_planimetry_ml(sections));
  }
}

TEST(Planimetry, OfASphereSweptForwardBackAndForwardIsThatOfOneSphere) {
  Sections sections;
  const Sections forward = sphere_linear(10.0, 41);
  for (int i = 0; i <= 30; ++i) sections.push_back(forward[static_cast<std::size_t>(i)]);
  for (int i = 29; i >= 8; --i) sections.push_back(forward[static_cast<std::size_t>(i)]);
  for (int i = 9; i <= 40; ++i) sections.push_back(forward[static_cast<std::size_t>(i)]);
  for (std::size_t i = 0; i < sections.size(); ++i) sections[i].frame = static_cast<int>(i) + 100;
  for (const double volume : volumes(sections)) EXPECT_NEAR(volume, sphere_ml(10.0), 0.01 * sphere_ml(10.0));

  // The part that is swept back lies between frames 130 and 152, and not along the same planes it came by.
  Random random(2);
  for (std::size_t i = 31; i < 53; ++i) {
    const Eigen::Vector3d normal = (sections[i].normal + 0.1 * random_direction(random)).normalized();
    sections[i] = sphere_section(sections[i].frame, 10.0, normal, sections[i].centroid_mm.z());
  }
  for (const double volume : volumes(sections)) EXPECT_NEAR(volume, sphere_ml(10.0), 0.01 * sphere_ml(10.0));
  const VolumeMeasurement measurement = measure_planimetry(sections);
  ASSERT_EQ(measurement.warnings.size(), 1u);
  EXPECT_EQ(measurement.warnings[0], "the sweep turns back between frames 130 and 152: that part is subtracted");
}

TEST(Planimetry, DoesNotWarnOfASteadySweepHoweverUneven) {
  Sections sections = sphere_linear(10.0, 20);
  sections.erase(sections.begin() + 5, sections.begin() + 12);
  EXPECT_TRUE(measure_planimetry(sections).warnings.empty());
  EXPECT_TRUE(measure_planimetry(sphere_fan(10.0, 1.02, 20)).warnings.empty());
  EXPECT_TRUE(measure_planimetry(sphere_free(10.0, 0.7, 20)).warnings.empty());
}

TEST(Planimetry, WarnsWhereTheOutlinesStopShortOfTheEnds) {
  const Sections sphere = sphere_linear(10.0, 21);
  const auto warnings = [&](int from, int to) {
    return measure_planimetry(
               std::span(sphere).subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from + 1)))
        .warnings;
  };
  // A section 1 mm inside a ball of 10 mm has 19 % of the largest; 2 mm inside, 36 %.
  EXPECT_TRUE(warnings(0, 20).empty());
  EXPECT_TRUE(warnings(1, 19).empty());
  ASSERT_EQ(warnings(0, 18).size(), 1u);
  EXPECT_NE(warnings(0, 18)[0].find("(36 % on frame 18 of the largest)"), std::string::npos) << warnings(0, 18)[0];
  ASSERT_EQ(warnings(2, 15).size(), 1u);
  EXPECT_NE(warnings(2, 15)[0].find("(36 % on frame 2 and 75 % on frame 15 of"), std::string::npos);
}

TEST(Planimetry, RefusesARotationalSweep) {
  // A kidney-shaped thing turned under the probe: by half a turn and more, and by a third of a turn.
  for (const double degrees : {100.0, 120.0, 170.0, 180.0, 200.0, 350.0}) {
    Sections sections;
    for (int i = 0; i <= 24; ++i) {
      const double turn = degrees / 180.0 * std::numbers::pi * i / 24.0;
      sections.push_back(section(i, {0.0, -std::sin(turn), std::cos(turn)}, 300.0 + 60.0 * std::cos(2.0 * turn),
                                 Eigen::Vector3d(0.5 * turn, std::cos(turn), std::sin(2.0 * turn))));
    }
    expect_nothing_measured(sections, "rotational");
  }
  Sections sphere;
  for (int i = 0; i <= 12; ++i) {
    const double turn = std::numbers::pi * i / 12.0;
    sphere.push_back(sphere_section(i, 10.0, {0.0, -std::sin(turn), std::cos(turn)}, 0.0));
  }
  EXPECT_FALSE(same_sense(sphere));
  expect_no_volume(sphere, "ends where it began");
  // Half a turn about an axis beside the centre: the end planes look at each other.
  Sections beside;
  for (int i = 0; i <= 12; ++i) {
    const double turn = std::numbers::pi * i / 12.0;
    beside.push_back(section(i, {0.0, -std::sin(turn), std::cos(turn)}, 300.0, {0.0, std::cos(turn), std::sin(turn)}));
  }
  EXPECT_FALSE(same_sense(beside));
}

TEST(Planimetry, RefusesASweepThatComesBackToWhereItBegan) {
  Sections sections = sphere_linear(10.0, 11);
  const Sections back = reversed(sections);
  sections.insert(sections.end(), back.begin(), back.end());
  expect_no_volume(sections, "ends where it began");
}

TEST(Planimetry, HasNoVolumeForOneSectionOrNone) {
  expect_no_volume({}, "no outlined frames");
  expect_no_volume({section(17, {0.0, 0.0, 1.0}, 300.0, {0.0, 0.0, 0.0})}, "only frame 17");
}

TEST(Planimetry, HasNoVolumeWhereNoSectionHasAnArea) {
  Sections sections = sphere_linear(10.0, 11);
  expect_no_volume({sections.front(), sections.back()}, "encloses an area");
}

TEST(Planimetry, RefusesValuesThatAreNotFinite) {
  Sections sections = sphere_linear(10.0, 11);
  sections[3].centroid_mm.x() = std::numeric_limits<double>::quiet_NaN();
  expect_no_volume(sections, "frame 3");
  sections = sphere_linear(10.0, 11);
  sections[4].vector_area_mm2.y() = std::numeric_limits<double>::infinity();
  expect_no_volume(sections, "frame 4");
}

TEST(Planimetry, TakesASectionTwiceAsOne) {
  const Sections sections = sphere_linear(10.0, 21);
  Sections twice = sections;
  twice.insert(twice.begin() + 9, sections[9]);
  const auto once = volumes(sections);
  const auto repeated = volumes(twice);
  EXPECT_NEAR(repeated[0], once[0], 1e-12);
  EXPECT_NEAR(repeated[1], once[1], 2e-3 * once[1]);
  EXPECT_NEAR(repeated[2], once[2], 2e-3 * once[2]);
}

}  // namespace
}  // namespace fathom
