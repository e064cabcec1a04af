#include "measurement/divided_interval.h"

#include <cmath>
#include <iostream>
#include <numbers>

#include <gtest/gtest.h>

#include "core/numbers.h"
#include "core/random.h"
#include "measurement/moved_section.h"
#include "measurement/partition_volume.h"
#include "sim/simulated_tracker.h"
#include "sim/studies/sweeps_study.h"

namespace fathom {
namespace {

struct Exam {
  DividedScan divided;
  std::vector<PlacedSections> sweeps;

  const Structure& structure() const { return divided.scan.outlines.front(); }
  double truth_ml() const { return divided.scan.truth.volume_ml; }

  PartitionedVolume measured(const std::vector<PlacedSections>& of) const {
    std::vector<SweepSections> made;
    for (const PlacedSections& sweep : of) made.push_back({sweep.sections, {}});
    return measure_partitions(structure(), std::span(&divided.locator, 1), divided.division.sweeps,
                              divided.division.partition, made);
  }
};

Exam exam_of(const std::string& object, const std::string& pattern, int frames) {
  SimulateOptions options;
  options.object = object;
  options.pattern = pattern;
  options.frames = frames;
  Exam exam{divided_scan(options), {}};
  for (const Sweep& sweep : exam.divided.division.sweeps) {
    exam.sweeps.push_back(
        placed_sections(exam.structure(), exam.divided.locator, sweep, exam.divided.scan.calibration));
  }
  return exam;
}

// As a tracker with noise and an outliner with scatter would have made them.
std::vector<PlacedSections> disturbed(const Exam& exam, const MeasurementErrors& errors, Random& random) {
  std::vector<PlacedSections> sweeps = exam.sweeps;
  for (PlacedSections& sweep : sweeps) {
    for (std::size_t i = 0; i < sweep.sections.size(); ++i) {
      const Eigen::Vector3d turn =
          gaussian_vector(random, errors.tracker_deg * std::numbers::pi / 180.0 / std::sqrt(3.0));
      const Eigen::AngleAxisd rotation(turn.norm(), turn.norm() > 0.0 ? turn.normalized() : Eigen::Vector3d::UnitX());
      const Eigen::Translation3d probe(sweep.probes_mm[i]);
      const Eigen::Translation3d shift(gaussian_vector(random, errors.tracker_mm / std::sqrt(3.0)));
      const double grown_mm = *errors.outline_mm * random.normal();
      sweep.sections[i] =
          moved(grown(sweep.sections[i], grown_mm), Eigen::Isometry3d(shift * probe * rotation * probe.inverse()));
      sweep.probes_mm[i] += shift.translation();
    }
  }
  return sweeps;
}

TEST(DividedInterval, IsThatOfOneSweepWhereNothingDividesIt) {
  const Exam exam = exam_of("sphere", "linear", 14);
  const MeasurementErrors errors{0.2, 0.3, 0.18};
  const auto divided = divided_interval(exam.sweeps, exam.divided.division.partition, errors, 0.01, 0.0);
  const auto sections = cross_sections(exam.structure(), exam.divided.locator, nullptr);
  const auto whole = volume_interval(
      sections, section_places(exam.structure(), sections, exam.divided.locator, exam.divided.scan.calibration), errors,
      0.01);
  ASSERT_TRUE(divided && whole);
  EXPECT_NEAR(divided->outlining_ml, whole->outlining_ml, 0.1 * whole->outlining_ml);
  EXPECT_NEAR(divided->tracker_ml, whole->tracker_ml, 0.1 * whole->tracker_ml);
  EXPECT_NEAR(divided->low_ml + divided->high_ml, whole->low_ml + whole->high_ml, 1e-6);
  EXPECT_NEAR(divided->high_ml - divided->low_ml, whole->high_ml - whole->low_ml,
              0.1 * (whole->high_ml - whole->low_ml));
}

// The stated deviations are those of volumes measured again and again.
TEST(DividedInterval, StatesTheScatterOfManyMeasurements) {
  const Exam exam = exam_of("ellipsoid", "sweeps-b", 40);
  for (const MeasurementErrors& errors : {MeasurementErrors{0.3, 0.0, 0.0}, {0.0, 0.4, 0.24}}) {
    const auto interval = divided_interval(exam.sweeps, exam.divided.division.partition, errors, 0.0, 0.0);
    ASSERT_TRUE(interval);
    Random random(5);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int kMany = 300;  // the deviation is known to 4 %
    for (int i = 0; i < kMany; ++i) {
      const double ml = *exam.measured(disturbed(exam, errors, random)).total.quadric_ml;
      sum += ml;
      squares += ml * ml;
    }
    const double deviation = std::sqrt(squares / kMany - sum / kMany * sum / kMany);
    EXPECT_NEAR(interval->outlining_ml + interval->tracker_ml, deviation, 0.15 * deviation);
  }
}

TEST(DividedInterval, IsUnknownWithTooFewSectionsInOnePart) {
  const Exam exam = exam_of("ellipsoid", "sweeps-b", 6);
  EXPECT_FALSE(divided_interval(exam.sweeps, exam.divided.division.partition, {0.1, 0.1, 0.1}, 0.0, 0.0));
}

TEST(DividedInterval, ReachesToWhatIsMissing) {
  const Exam exam = exam_of("ellipsoid", "sweeps-b", 40);
  const auto of = [&](double missing_ml) {
    return *divided_interval(exam.sweeps, exam.divided.division.partition, {0.1, 0.1, 0.1}, 0.0, missing_ml);
  };
  EXPECT_DOUBLE_EQ(of(0.5).high_ml, of(0.0).high_ml + 0.5);
  EXPECT_DOUBLE_EQ(of(0.5).low_ml, of(0.0).low_ml);
}

TEST(DividedIntervalStudy, CoversTheTrueVolume) {
  constexpr int kExamsEach = 4;
  constexpr double kMostNoise_mm = 0.3;
  Random random(11);
  int exams = 0;
  int covered = 0;
  int unknown = 0;
  double width_percent = 0.0;
  for (const char* object : {"ellipsoid", "box", "concave", "branching"}) {
    for (const char pattern : std::string("abcdefgh")) {
      int held = 0;
      int of_pattern = 0;
      for (int frames = 30; frames <= 60; frames += 10) {
        const Exam exam = exam_of(object, std::string("sweeps-") + pattern, frames);
        for (int i = 0; i < kExamsEach; ++i) {
          MeasurementErrors errors;
          errors.tracker_mm = kMostNoise_mm * random.uniform();
          errors.tracker_deg = kTurnOfNoise_deg_per_mm * errors.tracker_mm;
          errors.outline_mm = kMostNoise_mm * random.uniform();
          const auto sweeps = disturbed(exam, errors, random);
          const PartitionedVolume measured = exam.measured(sweeps);
          double missing_ml = 0.0;
          for (const PartitionVolume& part : measured.partitions) missing_ml += part.missing_ml;
          const auto interval = divided_interval(sweeps, exam.divided.division.partition, errors, 0.0, missing_ml);
          if (!interval || !measured.total.quadric_ml) {
            ++unknown;
            continue;
          }
          ++of_pattern;
          held += interval->low_ml <= exam.truth_ml() && exam.truth_ml() <= interval->high_ml;
          width_percent += 100.0 * (interval->high_ml - interval->low_ml) / exam.truth_ml();
        }
      }
      std::cout << object << " " << pattern << ": " << held << " of " << of_pattern << "\n";
      exams += of_pattern;
      covered += held;
    }
  }
  std::cout << covered << " of " << exams << " intervals hold the true volume, mean width "
            << format_rounded(width_percent / exams, 2) << " % of it; " << unknown << " exams have none\n";
  EXPECT_GE(covered, 0.93 * exams);
}

}  // namespace
}  // namespace fathom
