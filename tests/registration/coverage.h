#pragma once

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace fathom {

// Errors in units of the standard deviation stated: their spread must be 1, and 95 % of them below 1.96.
struct Coverage {
  double squares = 0.0;
  int within = 0;
  int count = 0;
  void add(const Eigen::VectorXd& errors, const Eigen::VectorXd& sd) {
    for (Eigen::Index i = 0; i < errors.size(); ++i) {
      const double normalised = errors[i] / sd[i];
      squares += normalised * normalised;
      within += std::abs(normalised) < 1.96 ? 1 : 0;
      ++count;
    }
  }
  double spread() const { return std::sqrt(squares / count); }
  double share() const { return static_cast<double>(within) / count; }
};

inline void expect_covered(const Coverage& result) {
  EXPECT_GT(result.spread(), 0.9);
  EXPECT_LT(result.spread(), 1.1);
  EXPECT_GT(result.share(), 0.93);
  EXPECT_LT(result.share(), 0.97);
}

}  // namespace fathom
