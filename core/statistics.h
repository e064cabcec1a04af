#pragma once

#include <vector>

#include <Eigen/Core>

namespace fathom {

/// The middle value, the higher of two; 0 of nothing.
double median(std::vector<double> values);

/// The value below which the share `share`, 0 to 1, of the values lies, by linear interpolation between the two about
/// it; 0 of nothing.
double quantile(std::vector<double> values, double share);

/// How many neighbouring errors count as one: 1 where they are independent, else 1 + 2 (r_1 + r_2 + ...) with their
/// autocorrelations r_k, up to the first that may be chance. A row of `errors` is one moment, in order of time;
/// variances worked out for independent errors are to be multiplied by it. Errors have mean 0.
double correlated_neighbours(const Eigen::MatrixXd& errors);

}  // namespace fathom
