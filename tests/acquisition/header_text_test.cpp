#include "acquisition/header_text.h"

#include <array>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/input_file.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

TEST(HeaderText, CountsAreWholeNumbersThatFit) {
  EXPECT_EQ(parse_count("0097"), 97u);
  for (const char* text : {"", "-1", "+1", "1.0", "18446744073709551616", "1 "}) {
    EXPECT_FALSE(parse_count(text)) << text;
  }
}

TEST(HeaderText, ReadsExactlyAsManyNumbersAsWanted) {
  std::array<double, 3> values = {};
  EXPECT_TRUE(parse_reals("  1   2\t3 ", values));
  EXPECT_EQ(values, (std::array<double, 3>{1, 2, 3}));
  EXPECT_FALSE(parse_reals("1 2", values));
  EXPECT_FALSE(parse_reals("1 2 3 4", values));
  EXPECT_FALSE(parse_reals("1 2 x", values));
}

TEST(HeaderText, MessagesShowOneLineOfBoundedLengthAndKeepUnicode) {
  EXPECT_EQ(printable("a\nb\x01\x7F\xFF"), "a?b???");
  EXPECT_EQ(printable("caf\xC3\xA9"), "caf\xC3\xA9");
  EXPECT_EQ(printable("\xC2\x85"), "??");
  EXPECT_LE(printable(std::string(100000, 'x')).size(), 64u);
}

TEST(HeaderLines, AreTheSameWhateverTheLineEnds) {
  const TestFolder folder;
  for (const std::string& end : {std::string("\n"), std::string("\r\n")}) {
    const InputFile file(folder.write("lines", "one" + end + end + "three" + end + "rest"));
    HeaderLines lines(file);
    EXPECT_EQ(lines.next(), "one");
    EXPECT_EQ(lines.next(), "");
    EXPECT_EQ(lines.next(), "three");
    EXPECT_EQ(lines.position(), file.size() - 4);
    EXPECT_EQ(lines.next(), "rest");
    EXPECT_FALSE(lines.line_was_ended());
    EXPECT_FALSE(lines.next().has_value());
  }
}

TEST(HeaderLines, SpanPiecesOfTheFile) {
  const TestFolder folder;
  std::string text;
  for (int i = 0; i < 40000; ++i)
    text += "line " + std::to_string(i) + std::string(static_cast<std::size_t>(i % 97), '.') + '\n';
  const InputFile file(folder.write("long", text));
  HeaderLines lines(file);
  for (int i = 0; i < 40000; ++i) {
    const auto line = lines.next();
    ASSERT_TRUE(line && line->starts_with("line " + std::to_string(i))) << i;
    ASSERT_EQ(line->substr(line->find_last_not_of('.') + 1).size(), static_cast<std::size_t>(i % 97));
  }
  EXPECT_FALSE(lines.next().has_value());
}

TEST(HeaderLines, RubbishWithoutLineEndsIsNotReadWhole) {
  const TestFolder folder;
  const auto path = folder.write("rubbish", "ObjectType = Image");
  std::filesystem::resize_file(path, 1ull << 33);
  expect_refused(path, "too long for a header");
}

}  // namespace
}  // namespace fathom
