#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace fathom {

/// What it costs to shift each point of a closed line by so many steps across it, from -`most` to `most`. Shifts that
/// no cost is given for are not allowed; one of 0 must be.
class ShiftCosts {
 public:
  ShiftCosts(std::size_t points, int most)
      : points_(points),
        most_(most),
        costs_(points * static_cast<std::size_t>(2 * most + 1), std::numeric_limits<double>::infinity()) {}

  std::size_t points() const { return points_; }
  int most() const { return most_; }
  double& at(std::size_t point, int shift) { return costs_[index(point, shift)]; }
  double at(std::size_t point, int shift) const { return costs_[index(point, shift)]; }

 private:
  std::size_t index(std::size_t point, int shift) const {
    return point * static_cast<std::size_t>(2 * most_ + 1) + static_cast<std::size_t>(shift + most_);
  }

  std::size_t points_;
  int most_;
  std::vector<double> costs_;
};

/// The shifts of least total cost, when a difference of d steps between neighbours costs `bend` d^2, and is
/// `kMostDifference` at most. Dynamic programming; exact, also across the place where the line closes.
std::vector<int> best_shifts(const ShiftCosts& costs, double bend);

inline constexpr int kMostDifference = 3;

}  // namespace fathom
