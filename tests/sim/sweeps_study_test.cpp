#include "sim/studies/sweeps_study.h"

#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(SweepsTableStudy, WholeTable) {
  std::vector<SweepsCell> cells;
  for (const SweepsCell& cell : published_sweeps_cells()) cells.push_back(measure_sweeps_cell(cell));
  std::cout << sweeps_table_text(cells);
  ASSERT_EQ(cells.size(), 32u);
  int as_published = 0;
  int continued = 0;
  int within = 0;
  for (const SweepsCell& cell : cells) {
    SCOPED_TRACE(cell.object + " " + cell.pattern);
    const SweepsMeasurement& most = cell.measurements.back();
    EXPECT_LT(std::abs(most.linear_percent), 2.0);
    EXPECT_LT(std::abs(most.cubic_percent), 2.0);
    EXPECT_LT(most.cut_off_mm, 0.1) << "a part of the object is in no image";
    if (cell.sustained && cell.sustained->sections <= cell.published_sections) ++as_published;
    if (cell.sustained_continued && cell.sustained_continued->sections <= cell.published_sections) ++continued;
    if (std::abs(cell.at_published.cubic_percent) <= 2.0) ++within;
  }
  std::cout << as_published << " of 32 cells need no more sections than published, " << continued
            << " with the ends continued; with the published number " << within << " are within 2 %\n";
  EXPECT_GE(as_published, 21);
}

}  // namespace
}  // namespace fathom
