#include "core/numbers.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fathom {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

TEST(ParseReal, TakesOneWholeFiniteNumber) {
  EXPECT_EQ(parse_real("-8.43482e-005"), -8.43482e-5);
  EXPECT_EQ(parse_real("+1."), 1.0);
  EXPECT_EQ(parse_real("345.627957"), 345.627957);
  EXPECT_EQ(parse_real("1.e-400"), 0.0);
  for (const std::string text :
       {"", " 1", "1 ", "1,5", "1.5mm", "nan", "inf", "-inf", "1e999", "0x10", "--1", "+-1", "-", "+", "."}) {
    EXPECT_EQ(parse_real(text), std::nullopt) << text;
  }
}

TEST(ParseReals, TakesNumbersWithAnyWhiteSpaceBetween) {
  EXPECT_THAT(parse_reals(" 1 0  -2.5\t1e3 \r\n"), Optional(ElementsAre(1.0, 0.0, -2.5, 1000.0)));
  EXPECT_THAT(parse_reals(" "), Optional(IsEmpty()));
  EXPECT_EQ(parse_reals("1 2 x"), std::nullopt);
  EXPECT_EQ(parse_reals("1, 2"), std::nullopt);
}

TEST(FormatReal, ReadsBackAsTheSameNumber) {
  std::mt19937_64 engine(11);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(engine());
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(parse_real(format_real(value)), value);
  }
  EXPECT_EQ(format_real(0.1), "0.1");
  EXPECT_EQ(parse_real(format_real(std::numeric_limits<double>::denorm_min())),
            std::numeric_limits<double>::denorm_min());
}

TEST(FormatRounded, NeverShowsMinusZero) {
  EXPECT_EQ(format_rounded(-0.3, 2), "-0.30");
  EXPECT_EQ(format_rounded(-0.001, 2), "0.00");
  EXPECT_EQ(format_rounded(12.5678, 1), "12.6");
  EXPECT_EQ(format_rounded(-7.6, 0), "-8");
  EXPECT_EQ(format_signed(-0.001, 2), "+0.00");
  EXPECT_EQ(format_signed(-1.25, 1), "-1.2");
  EXPECT_EQ(format_signed(std::nan(""), 1), "-");
  EXPECT_EQ(format_rounded(1e300, 0).size(), 301u);
}

}  // namespace
}  // namespace fathom
