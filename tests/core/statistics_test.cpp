#include "core/statistics.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

Eigen::MatrixXd following(int count, double share, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(count, 3);
  for (int i = 1; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) errors(i, axis) = share * errors(i - 1, axis) + random.normal();
  }
  return errors;
}

TEST(Statistics, MedianIsTheMiddle) {
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(median({5.0}), 5.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0, 2.0}), 4.0);
}

TEST(Statistics, QuantilesLieBetweenTheValuesAboutThem) {
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  EXPECT_EQ(quantile({5.0}, 0.25), 5.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0, 5.0, 4.0}, 0.25), 2.0);
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0}, 0.25), 1.75);
  EXPECT_EQ(quantile({4.0, 1.0, 2.0}, 0.0), 1.0);
  EXPECT_EQ(quantile({4.0, 1.0, 2.0}, 1.0), 4.0);
}

TEST(Statistics, IndependentErrorsCountOneByOne) {
  EXPECT_NEAR(correlated_neighbours(following(3000, 0.0, 1)), 1.0, 0.1);
  EXPECT_EQ(correlated_neighbours(Eigen::MatrixXd::Zero(100, 3)), 1.0);
  EXPECT_EQ(correlated_neighbours(Eigen::MatrixXd()), 1.0);
}

// Errors that keep a share a of the one before have autocorrelations a^k, so 1 + 2 sum = (1 + a) / (1 - a).
TEST(Statistics, ErrorsThatFollowEachOtherCountTogether) {
  EXPECT_NEAR(correlated_neighbours(following(20000, 0.5, 2)), 3.0, 0.3);
  EXPECT_NEAR(correlated_neighbours(following(20000, 0.8, 3)), 9.0, 0.9);
}

}  // namespace
}  // namespace fathom
