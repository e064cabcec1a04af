#include "sim/studies/sweeps_study.h"

#include <iostream>

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(SweepsTableStudy, WholeTable) {
  std::vector<SweepsCell> cells;
  for (const SweepsCell& cell : published_sweeps_cells()) cells.push_back(measure_sweeps_cell(cell));
  std::cout << sweeps_table_text(cells);
  EXPECT_EQ(cells.size(), 32u);
}

}  // namespace
}  // namespace fathom
