#include "segmentation/least_bent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace fathom {

namespace {

constexpr std::array<double, 4> kDifference = {-1.0, 3.0, -3.0, 1.0};
constexpr std::size_t kBeside = kDifference.size() - 1;  // elements of the band on one side of the diagonal
constexpr double kKeep = 1e9;                            // weight of points that stay
constexpr double kLeastOfStiffness = 1e-11;  // of a weight: with less, rounding would decide where points are

// Row i of a symmetric band matrix holds its columns i - kBeside to i.
using Band = std::vector<std::array<double, kBeside + 1>>;

double& element(Band& band, std::size_t row, std::size_t column) { return band[row][kBeside + column - row]; }

std::size_t first_column(std::size_t row) { return row - std::min(row, kBeside); }

// By Cholesky's factors, which replace the matrix; empty where it is singular to within rounding.
std::optional<Polygon> solved(Band& band, Polygon right) {
  const std::size_t count = right.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = first_column(i); j <= i; ++j) {
      double sum = element(band, i, j);
      for (std::size_t k = first_column(i); k < j; ++k) sum -= element(band, i, k) * element(band, j, k);
      if (j == i && !(sum > 0.0)) return std::nullopt;
      element(band, i, j) = j < i ? sum / element(band, j, j) : std::sqrt(sum);
    }
    for (std::size_t j = first_column(i); j < i; ++j) right[i] -= element(band, i, j) * right[j];
    right[i] /= element(band, i, i);
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t j = i + 1; j < std::min(count, i + kBeside + 1); ++j) right[i] -= element(band, j, i) * right[j];
    right[i] /= element(band, i, i);
  }
  return right;
}

}  // namespace

Polygon least_bent(std::span<const WantedPoint> wanted, double stiffness) {
  const std::size_t count = wanted.size();
  const double least = kLeastOfStiffness * stiffness;
  const double keep = std::max(kKeep, stiffness);
  Band band(count, {0.0});
  Polygon right(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = i == 0 || i + 1 == count ? keep : std::max(wanted[i].weight, least);
    element(band, i, i) = weight;
    right[i] = weight * wanted[i].place_px;
  }
  for (std::size_t i = 0; i + kBeside < count; ++i) {
    for (std::size_t a = 0; a <= kBeside; ++a) {
      for (std::size_t b = 0; b <= a; ++b) element(band, i + a, i + b) += stiffness * kDifference[a] * kDifference[b];
    }
  }
  if (std::optional<Polygon> line = solved(band, std::move(right))) return std::move(*line);
  Polygon places;
  for (const WantedPoint& point : wanted) places.push_back(point.place_px);
  return places;
}

}  // namespace fathom
