#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "core/text_file.h"
#include "sim/laboratory/gnuplot.h"
#include "sim/laboratory/table_text.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

StudyTable sample_table() {
  return {"t",
          "A table",
          {"name", "x (%)", "why"},
          {{"a|b", "-1.50 (+2)", "µ, \"so\""}, {"c", "-", "two\nlines"}},
          "A remark."};
}

TEST(TableText, IsAlignedMarkdown) {
  EXPECT_EQ(table_text(sample_table()),
            "A table\n\n"
            "| name |      x (%) | why       |\n"
            "| ---- | ---------: | --------- |\n"
            "| a\\|b | -1.50 (+2) | µ, \"so\"   |\n"
            "| c    |          - | two lines |\n"
            "\nA remark.\n");
}

TEST(TableText, IsCsvThatAnyProgramReads) {
  EXPECT_EQ(table_csv(sample_table()), "name,x (%),why\r\na|b,-1.50 (+2),\"µ, \"\"so\"\"\"\r\nc,-,\"two\nlines\"\r\n");
}

TEST(TableText, KeepsRemarksWithinALine) {
  StudyTable table = sample_table();
  table.remark.clear();
  for (int i = 0; i < 100; ++i) table.remark += "word ";
  const std::string text = table_text(table);
  std::size_t longest = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    longest = std::max(longest, end - at);
    at = end + 1;
  }
  EXPECT_LE(longest, 120u);
  EXPECT_GT(longest, 110u);
}

TEST(Gnuplot, DrawsWhateverTheTextsHold) {
  const ScratchFolder scratch;
  const std::string victim = (scratch / "victim").string();
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const std::string hostile = "it's `touch " + victim + "` $(touch " + victim + ") \" 100 %\n!touch " + victim + "\n'";
  StudyPlot plot{"p", hostile, hostile, hostile, {}, {}};
  plot.series.push_back({"it's `x`", {{1.0, 2.0}, {gap, gap}, {3.0, 1e300}}, {}, {}});
  plot.series.push_back({"bars", {{1.0, 2.0}, {2.0, 3.0}}, {1.0, 2.5}, {3.0, 3.5}});
  plot.series.push_back({"nothing", {}, {}, {}});
  const StudyPlot empty{"q", "empty", "x", "y", {}, {}};
  const std::string fault = draw_plots({{&plot, scratch / "it's.svg"}, {&empty, scratch / "empty.svg"}});
  if (fault.find("not installed") != std::string::npos) GTEST_SKIP() << fault;
  ASSERT_EQ(fault, "");
  EXPECT_EQ(scratch.names(), (std::vector<std::string>{"empty.svg", "it's.svg"})) << "nothing else is made or left";
  const std::string svg = read_text_file(scratch / "it's.svg", 1u << 20);
  EXPECT_NE(svg.find("it's `touch"), std::string::npos);
  EXPECT_NE(svg.find("bars"), std::string::npos);
}

}  // namespace
}  // namespace fathom
