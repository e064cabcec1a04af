#include "surface/equation.h"

#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "core/error.h"

namespace fathom {

namespace {

const Eigen::Vector3d kPlace(0.7, -1.3, 2.1);

double at_place(const std::string& expression) { return Equation(expression).value(kPlace); }

std::string complaint(const std::string& expression) {
  try {
    const Equation equation(expression);
    return "none; it is " + std::to_string(equation.value(kPlace));
  } catch (const Error& error) {
    return error.what();
  }
}

bool says(const std::string& expression, const std::string& part) {
  const std::string text = complaint(expression);
  if (text.find(part) != std::string::npos && text.find("; ") != std::string::npos) return true;
  ADD_FAILURE() << "'" << expression.substr(0, 80) << "' gives: " << text;
  return false;
}

}  // namespace

TEST(Equation, FollowsTheRulesOfArithmetic) {
  const double x = kPlace.x(), y = kPlace.y(), z = kPlace.z();
  EXPECT_DOUBLE_EQ(at_place("x^2+y^2+z^2-1"), x * x + y * y + z * z - 1);
  EXPECT_DOUBLE_EQ(at_place("x - y - z"), x - y - z);
  EXPECT_DOUBLE_EQ(at_place("x / y / z"), x / y / z);
  EXPECT_DOUBLE_EQ(at_place("x + y * z"), x + y * z);
  EXPECT_DOUBLE_EQ(at_place("(x + y) * z"), (x + y) * z);
  EXPECT_DOUBLE_EQ(at_place("-x^2"), -(x * x));
  EXPECT_DOUBLE_EQ(at_place("2^3^2"), 512.0);
  EXPECT_DOUBLE_EQ(at_place("y^3"), y * y * y);
  EXPECT_DOUBLE_EQ(at_place("2^-x"), std::pow(2.0, -x));
  EXPECT_DOUBLE_EQ(at_place("1.5e-2*z"), 0.015 * z);
  EXPECT_DOUBLE_EQ(at_place(" \t 3 "), 3.0);
}

TEST(Equation, KnowsItsFunctionsAndConstants) {
  const double x = kPlace.x(), y = kPlace.y(), z = kPlace.z();
  EXPECT_DOUBLE_EQ(at_place("sin(pi*x)"), std::sin(std::numbers::pi * x));
  EXPECT_DOUBLE_EQ(at_place("ln(e^z)"), z);
  EXPECT_DOUBLE_EQ(at_place("log(z)"), std::log(z));
  EXPECT_DOUBLE_EQ(at_place("log10(z)"), std::log10(z));
  EXPECT_DOUBLE_EQ(at_place("cbrt(y)"), std::cbrt(y));
  EXPECT_DOUBLE_EQ(at_place("atan2(y, x)"), std::atan2(y, x));
  EXPECT_DOUBLE_EQ(at_place("max(abs(x), abs(y), abs(z))"), z);
  EXPECT_DOUBLE_EQ(at_place("min(x, y, z)"), y);
  EXPECT_DOUBLE_EQ(at_place("sign(y) * floor(z) + ceil(x)"), -1.0);
}

TEST(Equation, ComparesAndChooses) {
  EXPECT_EQ(at_place("x < y"), 0.0);
  EXPECT_EQ(at_place("x >= y && z != 2"), 1.0);
  EXPECT_EQ(at_place("x == y || z <= 2.1"), 1.0);
  EXPECT_DOUBLE_EQ(at_place("y < 0 ? z : x"), kPlace.z());
}

TEST(Equation, SaysWhereItHasNoValue) {
  EXPECT_TRUE(std::isnan(at_place("sqrt(y)")));
  EXPECT_TRUE(std::isinf(at_place("1/(x-x)")));
}

TEST(Equation, RowsAreThePlacesOneByOne) {
  const Equation equation("x*y - sin(z) + x/3");
  const Eigen::Vector3d step(0.25, -0.5, 0.125);
  std::vector<double> row(17);
  equation.values(kPlace, step, row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    EXPECT_EQ(row[i], equation.value(kPlace + static_cast<double>(i) * step));
  }
}

TEST(Equation, ThreadsDoNotDisturbEachOther) {
  const Equation equation("x + 1000*y + 1000000*z");
  std::atomic<int> wrong = 0;
  cv::parallel_for_(
      cv::Range(0, 400),
      [&](const cv::Range& range) {
        std::vector<double> row(100);
        for (int i = range.start; i < range.end; ++i) {
          equation.values({0.0, static_cast<double>(i), 7.0}, Eigen::Vector3d::UnitX(), row);
          for (std::size_t k = 0; k < row.size(); ++k) {
            if (row[k] != static_cast<double>(k) + 1000.0 * i + 7e6) ++wrong;
          }
        }
      },
      400);
  EXPECT_EQ(wrong, 0);
}

TEST(Equation, RefusesWhatIsNoExpression) {
  EXPECT_TRUE(says("", "is empty"));
  EXPECT_TRUE(says("  \t", "is empty"));
  EXPECT_TRUE(says("x^2 + q", "'q'"));
  EXPECT_TRUE(says("x^2 + q", "at character 7"));
  EXPECT_TRUE(says("X + 1", "'X'"));
  EXPECT_TRUE(says("sinus(x)", "unknown"));
  EXPECT_TRUE(says("rnd()", "unknown"));
  EXPECT_TRUE(says("_pi", "unknown"));
  EXPECT_TRUE(says("(x + 1", "brackets"));
  EXPECT_TRUE(says("x + 1)", "brackets"));
  EXPECT_TRUE(says("x +", "ends too early"));
  EXPECT_TRUE(says("2x", "2*x"));
  EXPECT_TRUE(says("2 x", "2*x"));
  EXPECT_TRUE(says("x y", "2*x"));
  EXPECT_TRUE(says("sin(x, y)", "arguments"));
  EXPECT_TRUE(says("atan2(x)", "arguments"));
  EXPECT_TRUE(says("()", "the equation"));
  EXPECT_TRUE(says("x ** y", "the equation"));
  EXPECT_TRUE(says("x ? y", "the equation"));
  EXPECT_TRUE(says("x : y", "the equation"));
  EXPECT_TRUE(says("1e999", "the equation"));
  EXPECT_TRUE(says("min()", "arguments"));
}

TEST(Equation, RefusesSideEffectsAndSeveralResults) {
  EXPECT_TRUE(says("x = 3", "single ="));
  EXPECT_TRUE(says("x=y=z", "single ="));
  EXPECT_TRUE(says("x += 3", "single ="));
  EXPECT_TRUE(says("x === 3", "the equation"));
  EXPECT_TRUE(says("x, y", "comma"));
  EXPECT_TRUE(says("1,5 * x", "comma"));
  EXPECT_TRUE(says("(x, y)", "the equation"));
  EXPECT_TRUE(says("x; y", "at character 2"));
  EXPECT_TRUE(says("\"text\"", "at character 1"));
  EXPECT_TRUE(says("x\ny", "at character 2"));
  EXPECT_TRUE(says(std::string("x\0+1", 4), "at character 2"));
  EXPECT_TRUE(says("x\xc2\xb2", "at character 2"));
}

TEST(Equation, BoundsLengthAndDepth) {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '(') + "x" + std::string(static_cast<std::size_t>(depth), ')');
  };
  EXPECT_EQ(at_place(nested(Equation::kDeepest)), kPlace.x());
  EXPECT_TRUE(says(nested(Equation::kDeepest + 1), "brackets within each other"));
  std::string sum = "x";
  while (sum.size() + 2 <= Equation::kLongest) sum += "+1";
  EXPECT_NEAR(at_place(sum), kPlace.x() + static_cast<double>(sum.size() / 2), 1e-6);
  EXPECT_TRUE(says(sum + "+1+1", "longer than"));
}

}  // namespace fathom
