#include "sim/scan_plan.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "sim/studies/sweeps_study.h"
#include "tests/sim/scan_options.h"

namespace fathom {
namespace {

std::vector<std::string> names_of_table() {
  std::vector<std::string> names;
  for (const SweepPattern& pattern : sweep_table()) names.emplace_back(pattern.name);
  return names;
}

std::size_t sweeps_in(const std::string& name) {
  const auto table = sweep_table();
  return std::find_if(table.begin(), table.end(), [&](const SweepPattern& p) { return p.name == name; })->sweeps.size();
}

class EverySweepPattern : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ScanPlan, EverySweepPattern, testing::ValuesIn(names_of_table()), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EverySweepPattern, FramesAreSplitAmongItsSweepsAndTheseAreFound) {
  const std::size_t count = sweeps_in(GetParam());
  const int frames = 10 * static_cast<int>(count) + 1;  // one more than can be shared out evenly
  const DividedScan divided = divided_scan(options_of("ellipsoid", GetParam(), frames));
  ASSERT_EQ(divided.division.sweeps.size(), count);
  int next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(divided.division.sweeps[i].first, next);
    EXPECT_EQ(frame_count(divided.division.sweeps[i]), i == 0 ? 11 : 10);
    next = divided.division.sweeps[i].last + 1;
  }
  EXPECT_EQ(next, frames);
  EXPECT_FALSE(divided.division.partition.planes().empty());
}

// The longest way along an image's border that an open outline leaves out ends on that border, and everything it hides
// there is another sweep's to show.
TEST_P(EverySweepPattern, OpenOutlinesEndOnTheImagesBorderWhereAnotherSweepIsUsed) {
  const DividedScan divided = divided_scan(options_of("ellipsoid", GetParam(), 30));
  const RecordingHeader& header = divided.scan.recording->header();
  const Eigen::AlignedBox2d border(Eigen::Vector2d(-0.5, -0.5),
                                   Eigen::Vector2d(header.width - 0.5, header.height - 0.5));
  int open = 0;
  for (std::size_t s = 0; s < divided.division.sweeps.size(); ++s) {
    for (const Contour& contour : divided.scan.outlines.front().contours) {
      if (!contains(divided.division.sweeps[s], contour.frame)) continue;
      for (const Eigen::Vector2d& point : contour.points_px) {
        ASSERT_LE(border.exteriorDistance(point), 1e-6) << "frame " << contour.frame;
      }
      if (contour.closed) continue;
      ++open;
      for (const Eigen::Vector2d& end : {contour.points_px.front(), contour.points_px.back()}) {
        const double from_border = std::min((end - border.min()).minCoeff(), (border.max() - end).minCoeff());
        EXPECT_NEAR(from_border, 0.0, 1e-6) << "frame " << contour.frame;
      }
      EXPECT_TRUE(stays_open(contour.points_px, *divided.locator.reference_from_image(contour.frame), s,
                             divided.division.partition))
          << "frame " << contour.frame;
    }
  }
  // The images of (c) hold the whole ellipsoid, all others cut it.
  EXPECT_EQ(open > 0, GetParam() != "sweeps-c");
}

TEST(ScanPlan, EverySweepHasAtLeastOneFrame) {
  EXPECT_EQ(frames_of_sweeps(3, 3), (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(frames_of_sweeps(8, 3), (std::vector<int>{3, 3, 2}));
  EXPECT_THROW(frames_of_sweeps(2, 3), Error);
  EXPECT_THROW(simulate(options_of("box", "sweeps-e", 2)), Error);
}

TEST_P(EverySweepPattern, EveryPartOfTheObjectsIsInTheImagesOfItsSweep) {
  for (const char* object : {"box", "branching"}) {
    const int frames = kMostPerSweep * static_cast<int>(sweeps_in(GetParam()));
    EXPECT_LT(cut_off_mm(divided_scan(options_of(object, GetParam(), frames))), 0.1) << object;
  }
}

// Two and three sweeps, parallel, turning and fans, of every object.
TEST(ScanPlan, PartitionsAddUpToTheObjectInSweepsThatOverlap) {
  const std::pair<const char*, const char*> cells[] = {
      {"ellipsoid", "sweeps-c"}, {"ellipsoid", "sweeps-e"}, {"box", "sweeps-a"}, {"concave", "sweeps-f"}};
  for (const auto& [object, pattern] : cells) {
    const int frames = kMostPerSweep * static_cast<int>(sweeps_in(pattern));
    const SweepsMeasurement measured = measure_sweeps(object, pattern, frames);
    EXPECT_LT(std::abs(measured.cubic_percent), 2.0) << object << " " << pattern;
    EXPECT_LT(std::abs(measured.linear_percent), 2.0) << object << " " << pattern;
    EXPECT_LT(measured.cut_off_mm, 0.1) << object << " " << pattern;
  }
}

}  // namespace
}  // namespace fathom
