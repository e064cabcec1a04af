#include "core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr int kDraws = 200000;

std::vector<double> normals(std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(kDraws);
  for (double& value : values) value = random.normal();
  return values;
}

TEST(Random, GivesTheSequenceThatTheStandardFixes) {
  // ISO C++, [rand.predef]: the 10000th number of mt19937_64 seeded with 5489.
  Random random(5489);
  for (int i = 1; i < 10000; ++i) random.uniform();
  EXPECT_EQ(random.uniform(), std::ldexp(static_cast<double>(9981545732273789042u >> 11), -53));
}

TEST(Random, RepeatsItselfForASeedAndOnlyForThatSeed) {
  Random a(42), b(42), c(43);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const double value = a.normal();
    EXPECT_EQ(value, b.normal());
    equal += value == c.normal();
  }
  EXPECT_LT(equal, 5);
}

TEST(Random, UniformFillsItsIntervalEvenly) {
  Random random(1);
  constexpr int kBins = 64;
  std::array<int, kBins> counts{};
  double sum = 0.0, square_sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-3.0, 5.0);
    ASSERT_GE(value, -3.0);
    ASSERT_LT(value, 5.0);
    const double unit = (value + 3.0) / 8.0;
    ++counts[static_cast<std::size_t>(unit * kBins)];
    sum += unit;
    square_sum += unit * unit;
  }
  double chi_square = 0.0;
  for (const int count : counts) chi_square += std::pow(count - kDraws / kBins, 2) / (kDraws / kBins);
  EXPECT_LT(chi_square, 103.4);  // 63 degrees of freedom: exceeded by chance once in a thousand seeds
  EXPECT_GT(chi_square, 33.0);   // and fallen short of, too: more even than chance is not random
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 0.5, 4.0 / std::sqrt(12.0 * kDraws));
  EXPECT_NEAR(square_sum / kDraws - mean * mean, 1.0 / 12.0, 4.0 / std::sqrt(180.0 * kDraws));
}

TEST(Random, NormalHasTheMomentsOfAGaussian) {
  std::array<double, 5> moments{};
  for (const double value : normals(2)) {
    for (int power = 1; power <= 4; ++power) {
      moments[static_cast<std::size_t>(power)] += std::pow(value, power) / kDraws;
    }
  }
  // Four standard errors each: the variances of x, x^2, x^3, x^4 are 1, 2, 15, 96.
  const double error = 4.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(moments[1], 0.0, error);
  EXPECT_NEAR(moments[2], 1.0, error * std::sqrt(2.0));
  EXPECT_NEAR(moments[3], 0.0, error * std::sqrt(15.0));
  EXPECT_NEAR(moments[4], 3.0, error * std::sqrt(96.0));
}

TEST(Random, NormalFollowsTheGaussianDistributionIntoItsTails) {
  std::vector<double> values = normals(3);
  std::sort(values.begin(), values.end());
  double largest_gap = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double expected = 0.5 * std::erfc(-values[static_cast<std::size_t>(i)] / std::numbers::sqrt2);
    largest_gap = std::max({largest_gap, std::abs(expected - static_cast<double>(i) / kDraws),
                            std::abs(expected - static_cast<double>(i + 1) / kDraws)});
  }
  EXPECT_LT(largest_gap * std::sqrt(static_cast<double>(kDraws)), 1.95);  // Kolmogorov: once in a thousand
  EXPECT_GT(values.back(), 3.8);
  EXPECT_LT(values.front(), -3.8);
  EXPECT_LT(values.back(), 6.5);
}

TEST(Random, SuccessiveNumbersAreUncorrelated) {
  const std::vector<double> values = normals(4);
  for (std::size_t lag = 1; lag <= 3; ++lag) {
    double product = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i) product += values[i] * values[i - lag];
    EXPECT_LT(std::abs(product) / kDraws, 4.0 / std::sqrt(static_cast<double>(kDraws))) << lag;
  }
}

}  // namespace
}  // namespace fathom
