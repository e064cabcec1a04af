#pragma once

#include <algorithm>
#include <cmath>

namespace fathom {

/// Errors of repeated measurements.
struct ErrorSums {
  double sum = 0.0;
  double square = 0.0;
  int count = 0;

  void add(double error) {
    sum += error;
    square += error * error;
    ++count;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(square / count); }
  double scatter() const { return std::sqrt(std::max(0.0, square / count - mean() * mean())); }
};

}  // namespace fathom
