#include "segmentation/best_shifts.h"

#include <algorithm>
#include <cstdint>

namespace fathom {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// The cheapest way around that starts and ends with one shift.
class Round {
 public:
  Round(const ShiftCosts& costs, double bend)
      : costs_(costs),
        bend_(bend),
        width_(static_cast<std::size_t>(2 * costs.most() + 1)),
        came_(costs.points() * width_) {}

  double cost(int start) {
    const int most = costs_.most();
    std::vector<double> now(width_, kNever);
    std::vector<double> next(width_);
    now[static_cast<std::size_t>(start + most)] = costs_.at(0, start);
    for (std::size_t point = 1; point <= costs_.points(); ++point) {
      const bool last = point == costs_.points();
      for (int shift = -most; shift <= most; ++shift) {
        double best = kNever;
        int from = shift;
        for (int before = std::max(-most, shift - kMostDifference); before <= std::min(most, shift + kMostDifference);
             ++before) {
          const double cost =
              now[static_cast<std::size_t>(before + most)] + bend_ * (shift - before) * (shift - before);
          if (cost >= best) continue;
          best = cost;
          from = before;
        }
        const auto column = static_cast<std::size_t>(shift + most);
        if (last) {
          if (shift != start) continue;
          end_ = from;
          return best;
        }
        next[column] = best + costs_.at(point, shift);
        came_[point * width_ + column] = static_cast<std::int16_t>(from);
      }
      std::swap(now, next);
    }
    return kNever;
  }

  std::vector<int> shifts() const {
    std::vector<int> all(costs_.points());
    int shift = end_;
    for (std::size_t point = costs_.points(); point-- > 0;) {
      all[point] = shift;
      if (point > 0) shift = came_[point * width_ + static_cast<std::size_t>(shift + costs_.most())];
    }
    return all;
  }

 private:
  const ShiftCosts& costs_;
  double bend_;
  std::size_t width_;
  std::vector<std::int16_t> came_;
  int end_ = 0;
};

}  // namespace

std::vector<int> best_shifts(const ShiftCosts& costs, double bend) {
  std::vector<int> best(costs.points(), 0);
  if (costs.points() == 0) return best;
  Round round(costs, bend);
  double least = kNever;
  for (int start = -costs.most(); start <= costs.most(); ++start) {
    const double cost = round.cost(start);
    if (!(cost < least)) continue;
    least = cost;
    best = round.shifts();
  }
  return best;
}

}  // namespace fathom
