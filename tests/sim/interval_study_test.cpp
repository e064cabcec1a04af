#include "sim/studies/interval_study.h"

#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "sim/studies/next_outline_study.h"

namespace fathom {
namespace {

TEST(IntervalStudy, CoversTheTrueVolumeAndIsNoWiderThanNeeded) {
  const auto rows = interval_study();
  std::cout << interval_study_text(rows);
  const IntervalStudyRow all = pooled(rows);
  EXPECT_EQ(all.exams, 2000);
  EXPECT_GE(all.covered, 0.93 * all.exams);
  EXPECT_LE(all.covered, 0.97 * all.exams);
  EXPECT_LE(all.width_percent, 1.5 * all.oracle_width_percent);
}

TEST(IntervalStudy, IsSafeWhereTheScatterOfOutlinesIsJudged) {
  const auto rows = interval_study({.exams = 2000, .seed = 1, .outline_known = false});
  std::cout << interval_study_text(rows);
  EXPECT_GE(pooled(rows).covered, 0.93 * pooled(rows).exams);
}

TEST(NextOutlineStudy, NeedsFewerSections) {
  const auto rows = next_outline_study();
  std::cout << next_outline_text(rows);
  int no_more = 0;
  int fewer = 0;
  for (const NextOutlineRow& row : rows) {
    no_more += row.asked.value_or(99) <= row.even_cubic.value_or(99);
    fewer += row.asked.value_or(99) < row.even_cubic.value_or(99);
  }
  EXPECT_GE(no_more, 12);
  EXPECT_GE(fewer, 8);
}

TEST(MissingEndsStudy, OfSixObjects) {
  const auto rows = missing_ends_study();
  std::cout << missing_ends_text(rows);
  for (const MissingEndsRow& row : rows) {
    // A cone that is scanned from its tip grows up to its face: the program says that it cannot tell.
    EXPECT_EQ(row.both_told, row.object != "cone" || row.pattern != "linear") << row.object << " " << row.pattern;
    if (row.both_told) {
      EXPECT_LT(std::abs(row.corrected_percent[1]), 2.0) << row.object << " " << row.pattern;
    }
  }
}

}  // namespace
}  // namespace fathom
