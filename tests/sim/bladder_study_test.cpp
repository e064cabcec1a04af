#include "sim/studies/bladder_study.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(BladderPatient, FillsBetweenVoidsAndIsEmptiedByThem) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const BladderPatient patient(seed);
    for (std::size_t i = 0; i < kBladderPairs; ++i) {
      EXPECT_GT(patient.volume_ml(kBladderScans_min[2 * i + 1]), patient.volume_ml(kBladderScans_min[2 * i]));
    }
    for (std::size_t i = 0; i < kBladderVoids; ++i) {
      const double before_ml = patient.volume_ml(void_time_min(i) - 1e-9);
      const double after_ml = patient.volume_ml(void_time_min(i) + 1e-9);
      EXPECT_NEAR(before_ml - after_ml, patient.voided_ml(i), 1e-5);
      EXPECT_LE(std::abs(patient.measured_void_ml(i) - patient.voided_ml(i)), 1.0);
      EXPECT_GT(after_ml, 0.0);
    }
    EXPECT_LT(patient.volume_ml(kBladderScans_min.back()), 0.35 * patient.volume_ml(0.0));
  }
}

TEST(BladderPatient, HasABladderOfExactlyItsVolumeThatIsFlatterWhenEmpty) {
  const BladderPatient patient(3);
  const auto height_of = [](const Phantom& bladder) {
    return bladder.solid->contact(Eigen::Vector3d::UnitZ()).point_mm.z() -
           bladder.solid->contact(-Eigen::Vector3d::UnitZ()).point_mm.z();
  };
  const auto length_of = [](const Phantom& bladder) {
    return 2.0 * bladder.solid->contact(Eigen::Vector3d::UnitX()).point_mm.x();
  };
  const Phantom full = patient.bladder(400.0);
  const Phantom empty = patient.bladder(20.0);
  EXPECT_NEAR(full.solid->volume_mm3(), 400e3, 1e-6);
  EXPECT_NEAR(empty.solid->volume_mm3(), 20e3, 1e-6);
  EXPECT_LT(height_of(empty) / length_of(empty), 0.7 * height_of(full) / length_of(full));
}

TEST(VoidingExperiment, FindsWhatWasVoidedFromTrueVolumes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const BladderPatient patient(seed);
    std::vector<double> volumes_ml;
    for (const double minutes : kBladderScans_min) volumes_ml.push_back(patient.volume_ml(minutes));
    const VoidingExperiment experiment = evaluate_voiding(patient, volumes_ml);
    for (std::size_t i = 0; i < kBladderVoids; ++i) {
      EXPECT_NEAR(experiment.known_ml[i], patient.voided_ml(i), 0.3);
      EXPECT_NEAR(experiment.estimated_ml[i], patient.voided_ml(i), 1.5) << "rates change smoothly";
    }
  }
}

TEST(Regression, FindsALineAndHowWellItFits) {
  const Regression line = regression_of({{1.0, 5.0}, {2.0, 7.0}, {4.0, 11.0}});
  EXPECT_NEAR(line.slope, 2.0, 1e-12);
  EXPECT_NEAR(line.intercept, 3.0, 1e-12);
  EXPECT_NEAR(line.r, 1.0, 1e-12);
  EXPECT_NEAR(regression_of({{0.0, 0.0}, {1.0, 1.0}, {2.0, 0.0}}).r, 0.0, 1e-12);
}

TEST(BladderStudy, TrueOutlinesTellWhatWasVoided) {
  const BladderPatient patient(case_seed({}, 0));
  std::vector<double> volumes_ml;
  double before_ml = 0.0;
  for (std::size_t number = 0; number < kBladderScans_min.size(); ++number) {
    const BladderScan scan = scan_bladder(patient, number, number + 1);
    EXPECT_GE(scan.true_outlines.contours.size(), 12u);
    const auto volume_ml = bladder_volumes_ml(scan, scan.true_outlines)[1];
    ASSERT_TRUE(volume_ml);
    volumes_ml.push_back(*volume_ml);
    const bool voided_much = number >= 4 && number % 2 == 0;  // the first void may be less than what fills it
    EXPECT_TRUE(!voided_much || scan.scan.truth.volume_ml < before_ml) << number;
    before_ml = scan.scan.truth.volume_ml;
  }
  const VoidingExperiment experiment = evaluate_voiding(patient, volumes_ml);
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < kBladderVoids; ++i) points.emplace_back(patient.voided_ml(i), experiment.known_ml[i]);
  EXPECT_NEAR(regression_of(points).slope, 1.0, 0.01);
}

TEST(BladderStudy, TheSameSeedGivesTheSameBytes) {
  const BladderPatient patient(3);
  const auto bytes = [&](std::uint64_t seed) {
    BladderScan scan = scan_bladder(patient, 9, seed);
    auto& contours = scan.true_outlines.contours;
    contours = {contours.at(contours.size() / 2)};
    return contours_json({assisted_outlines(scan, nullptr)});
  };
  EXPECT_EQ(bytes(1), bytes(1));
  EXPECT_NE(bytes(1), bytes(2));
}

}  // namespace
}  // namespace fathom
