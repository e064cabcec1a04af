#include "sim/studies/sweeps_study.h"

#include <iostream>

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(SweepsTableStudy, WholeTable) {
  std::vector<SweepsCell> cells;
  for (const SweepsCell& cell : published_sweeps_cells()) cells.push_back(measure_sweeps_cell(cell));
  std::cout << sweeps_table_text(cells);
  for (const SweepsCell& cell : cells) {
    std::cout << cell.object << " " << cell.pattern << ":";
    for (const auto& m : cell.measurements) printf(" %d/%.1f/%.1f", m.sections, m.linear_percent, m.cubic_percent);
    printf(" CUT %.2f", cell.measurements.back().cut_off_mm);fflush(stdout);
    std::cout << "\n";
  }
}

}  // namespace
}  // namespace fathom
