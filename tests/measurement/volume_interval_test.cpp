#include "measurement/volume_interval.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "measurement/planimetry.h"

namespace fathom {
namespace {

constexpr double kRadius = 20.0;
constexpr double kBallMl = 4.0 / 3.0 * std::numbers::pi * kRadius * kRadius * kRadius / 1000.0;

// A ball cut by parallel planes, a stand-in for the sections of a sweep, at the given places along z.
std::vector<CrossSection> ball(const std::vector<double>& places) {
  std::vector<CrossSection> sections;
  for (const double z : places) {
    CrossSection section;
    section.frame = static_cast<int>(10 * sections.size());
    section.vector_area_mm2 = Eigen::Vector3d(0, 0, std::numbers::pi * std::max(0.0, kRadius * kRadius - z * z));
    section.centroid_mm = Eigen::Vector3d(3.0, -2.0, z);
    section.along_mm = z - places.front();
    sections.push_back(section);
  }
  return sections;
}

std::vector<double> evenly(int count) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(kRadius * (2.0 * i / (count - 1) - 1.0));
  return places;
}

std::vector<SectionPlace> places_of(const std::vector<CrossSection>& sections) {
  std::vector<SectionPlace> places;
  for (const CrossSection& section : sections) {
    const double area = section.vector_area_mm2.norm();
    places.push_back({2.0 * std::sqrt(std::numbers::pi * area), section.centroid_mm + Eigen::Vector3d(0, -100, 0)});
  }
  return places;
}

TEST(QuadricPlanimetry, IsExactForABallCutAtAnySpacing) {
  EXPECT_NEAR(quadric_planimetry_ml(ball({-20.0, 0.0, 20.0})), kBallMl, 1e-9 * kBallMl);
  EXPECT_NEAR(quadric_planimetry_ml(ball({-20.0, -17.0, -3.0, 11.0, 20.0})), kBallMl, 1e-9 * kBallMl);
  auto sections = ball({-20.0, -17.0, -3.0, 11.0, 20.0});
  for (CrossSection& section : sections) section.along_mm = 0.0;  // not known: the centroids' way is taken
  EXPECT_NEAR(quadric_planimetry_ml(sections), kBallMl, 1e-9 * kBallMl);
}

TEST(QuadricPlanimetry, DoesNotDependOnTheEndThatIsReadFirst) {
  const auto sections = ball({-20.0, -16.0, -5.0, 2.0, 9.0, 20.0});
  std::vector<CrossSection> reversed(sections.rbegin(), sections.rend());
  for (CrossSection& section : reversed) section.along_mm = 40.0 - section.along_mm;
  EXPECT_NEAR(quadric_planimetry_ml(reversed), quadric_planimetry_ml(sections), 1e-9 * kBallMl);
}

TEST(VolumeInterval, OfScatteredOutlinesIsWhatScatterDoes) {
  const auto sections = ball(evenly(11));
  const MeasurementErrors errors{.outline_mm = 0.5};
  const auto interval = volume_interval(sections, places_of(sections), errors);
  ASSERT_TRUE(interval);
  // Each outline grows the volume of its slab by perimeter x spacing; the errors add up as squares.
  double squares = 0.0;
  for (const SectionPlace& place : places_of(sections)) squares += std::pow(0.5 * 4.0 * place.perimeter_mm, 2);
  EXPECT_NEAR(interval->outlining_ml, std::sqrt(squares) / 1000.0, 1e-9);
  EXPECT_LT(interval->spacing_ml, 0.001 * kBallMl);
  EXPECT_LT(interval->low_ml, kBallMl);
  EXPECT_GT(interval->high_ml, kBallMl);
}

TEST(VolumeInterval, OfTrackerNoiseAgreesWithDisturbedSections) {
  const auto sections = ball(evenly(13));
  const MeasurementErrors errors{.outline_mm = 0.0, .tracker_mm = 0.6};
  const auto interval = volume_interval(sections, places_of(sections), errors);
  ASSERT_TRUE(interval);
  Random random(7);
  double squares = 0.0;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    auto moved = sections;
    for (CrossSection& section : moved) {
      for (double& x : section.centroid_mm) x += 0.6 / std::sqrt(3.0) * random.normal();
    }
    squares += std::pow(quadric_planimetry_ml(moved) - kBallMl, 2);
  }
  EXPECT_NEAR(interval->tracker_ml / std::sqrt(squares / kSamples), 1.0, 0.1);
}

TEST(VolumeInterval, GrowsWithScatterThatNobodyTold) {
  auto sections = ball(evenly(11));
  const auto smooth = volume_interval(sections, places_of(sections), {});
  for (std::size_t i = 1; i < sections.size(); i += 2) sections[i].vector_area_mm2 *= 1.1;
  const auto rough = volume_interval(sections, places_of(sections), {});
  ASSERT_TRUE(smooth && rough);
  EXPECT_GT(rough->spacing_ml, 5.0 * smooth->spacing_ml);
}

TEST(VolumeInterval, NeedsFourSectionsAndAVolume) {
  const auto three = ball({-20.0, 0.0, 20.0});
  EXPECT_FALSE(volume_interval(three, places_of(three), {}));
  const auto there_and_back = ball({-20.0, 0.0, 20.0, 0.0, -20.0});
  EXPECT_FALSE(volume_interval(there_and_back, places_of(there_and_back), {}));
}

TEST(VolumeInterval, RefusesErrorsThatAreNone) {
  EXPECT_THROW((MeasurementErrors{.outline_mm = -0.1}.check()), Error);
  EXPECT_THROW((MeasurementErrors{.outline_mm = {}, .tracker_mm = std::nan("")}.check()), Error);
}

}  // namespace
}  // namespace fathom
