#include "sim/studies/sweeps_study.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/studies/sweeps_table.h"

namespace fathom {
namespace {

TEST(SweepsCells, AreSummedUpByTheFewestSectionsThatHoldAndTheNearestToThePublished) {
  SweepsCell cell;
  cell.published_sections = 13;
  const double cubic_percent[] = {-1.0, -3.0, 1.9, -1.2};  // the first is luck: the second is worse
  for (int i = 0; i < 4; ++i) {
    SweepsMeasurement measurement;
    measurement.frames = 20 + i;
    measurement.sections = 10 + 2 * i;
    measurement.cubic_percent = cubic_percent[i];
    measurement.quadric_percent = i == 3 ? std::nan("") : 0.0;
    cell.measurements.push_back(measurement);
  }
  summarise(cell);
  ASSERT_TRUE(cell.sustained);
  EXPECT_EQ(cell.sustained->sections, 14);
  EXPECT_FALSE(cell.sustained_quadric) << "the largest number has no volume, so nothing holds up to it";
  EXPECT_EQ(cell.at_published.sections, 12);
}

TEST(SweepsCells, OfParallelSweepsThroughABoxAreExact) {
  const SweepsMeasurement measured = measure_sweeps("box", "sweeps-a", 16);
  EXPECT_LT(std::abs(measured.linear_percent), 0.05);
  EXPECT_LT(std::abs(measured.quadric_percent), 0.05);
  EXPECT_LT(measured.cut_off_mm, 0.1);
}

TEST(SweepsTableStudy, WholeTable) {
  std::vector<SweepsCell> cells;
  for (const SweepsCell& cell : published_sweeps_cells()) cells.push_back(measure_sweeps_cell(cell));
  ASSERT_EQ(cells.size(), 32u);
  for (const SweepsCell& cell : cells) {
    SCOPED_TRACE(cell.object + " " + cell.pattern);
    const SweepsMeasurement& most = cell.measurements.back();
    EXPECT_LT(std::abs(most.linear_percent), 2.0);
    EXPECT_LT(std::abs(most.cubic_percent), 2.0);
    EXPECT_LT(std::abs(most.quadric_percent), 2.0);
    EXPECT_LT(most.cut_off_mm, 0.1) << "a part of the object is in no image";
  }
}

}  // namespace
}  // namespace fathom
