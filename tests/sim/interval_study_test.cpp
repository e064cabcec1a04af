#include "sim/studies/interval_study.h"

#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "sim/studies/next_outline_study.h"

namespace fathom {
namespace {

TEST(Intervals, GrowWithTheErrorsAndHoldTheTrueVolumeOfASphere) {
  const IntervalCounts counts = measure_intervals({"sphere", "linear", 10}, 40, 1);
  EXPECT_EQ(counts.exams, 40);
  EXPECT_GE(counts.covered, 34);  // fewer than one run in ten thousand
  EXPECT_GT(counts.judged_width_percent, counts.width_percent) << "who is told more is surer";
}

TEST(Intervals, AreTheSameForTheSameSeedAndOthersForAnother) {
  const IntervalCase of{"cone", "linear", 8};
  EXPECT_EQ(measure_intervals(of, 3, 7).width_percent, measure_intervals(of, 3, 7).width_percent);
  EXPECT_NE(measure_intervals(of, 3, 7).width_percent, measure_intervals(of, 3, 8).width_percent);
}

TEST(IntervalStudy, CoversTheTrueVolumeAndIsNoWiderThanNeeded) {
  constexpr int kExamsEach = 9;  // 2016 exams
  IntervalCounts all;
  std::uint64_t seed = 0;
  for (const IntervalCase& of : interval_cases()) all += measure_intervals(of, kExamsEach, ++seed);
  EXPECT_GE(all.exams, 2000);
  EXPECT_GE(all.covered, 0.93 * all.exams);
  EXPECT_LE(all.covered, 0.97 * all.exams);
  EXPECT_LE(all.width_percent, 1.5 * all.oracle_width_percent);
  EXPECT_GE(all.judged_covered, 0.93 * all.exams) << "where the scatter of outlines is judged";
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
