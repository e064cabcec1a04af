#include "core/statistics.h"

#include <algorithm>
#include <cmath>

namespace fathom {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

double correlated_neighbours(const Eigen::MatrixXd& errors) {
  const Eigen::Index n = errors.rows();
  const double squares = errors.squaredNorm();
  if (n < 8 || squares <= 0.0) return 1.0;
  const double chance = 2.0 / std::sqrt(static_cast<double>(errors.size()));
  double count = 1.0;
  constexpr Eigen::Index kMostLags = 1000;
  for (Eigen::Index lag = 1; lag <= std::min(kMostLags, n / 4); ++lag) {
    const double products = errors.topRows(n - lag).cwiseProduct(errors.bottomRows(n - lag)).sum();
    const double correlation = products / squares * static_cast<double>(n) / static_cast<double>(n - lag);
    if (correlation < chance) break;
    count += 2.0 * correlation;
  }
  return count;
}

}  // namespace fathom
