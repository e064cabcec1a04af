#include "segmentation/wire_costs.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace fathom {

namespace {

// Of a step to the side; one to a corner costs as much more as it is longer. 255 is the most that a corner may cost.
constexpr double kLeast = 12.0;  // length counts also along the best edge: where nothing is seen, lines go straight
constexpr double kForMisfit = 146.0;
constexpr double kOffRidge = 12.0;
constexpr double kDiagonal = 1.4142135623730951;
// Fits are looked up by gradient; finer differences do not matter.
constexpr int kTable = 1024;
constexpr double kTableReach = 64.0;  // standard deviations, either way

class FitTable {
 public:
  explicit FitTable(const EdgePreference& preference) {
    for (int i = 0; i < kTable; ++i) {
      const double across = (2.0 * i / (kTable - 1) - 1.0) * kTableReach;
      misfit_[static_cast<std::size_t>(i)] = static_cast<float>(kForMisfit * (1.0 - preference.fit(across)));
    }
  }
  float misfit(float across) const {
    constexpr auto kScale = static_cast<float>(0.5 * (kTable - 1) / kTableReach);
    const int index = static_cast<int>(across * kScale + 0.5F * kTable);
    return misfit_[static_cast<std::size_t>(std::min(std::max(index, 0), kTable - 1))];
  }

 private:
  std::array<float, kTable> misfit_;
};

}  // namespace

WireCosts wire_costs(const EdgeMap& map, const EdgePreference& preference) {
  const cv::Size size = map.gradient.size();
  WireCosts costs{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.area()) * kWireSteps, std::uint8_t{0})};
  const FitTable table(preference);
  for (int y = 0; y < size.height; ++y) {
    for (int i = 0; i < kWireSteps; ++i) {
      const auto step = static_cast<std::size_t>(i);
      const int dx = kWireStepX[step];
      const int dy = kWireStepY[step];
      if (y + dy < 0 || y + dy >= size.height) continue;
      const double length = dx != 0 && dy != 0 ? kDiagonal : 1.0;
      const auto ax = static_cast<float>(0.5 * dx / length);
      const auto ay = static_cast<float>(0.5 * dy / length);
      const auto per_length = static_cast<float>(length);
      const auto* here = map.gradient.ptr<cv::Vec2f>(y);
      const auto* there = map.gradient.ptr<cv::Vec2f>(y + dy);
      const std::uint8_t* ridge = map.ridge.ptr<std::uint8_t>(y + dy);
      std::uint8_t* row = &costs.steps[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) * kWireSteps];
      const int end = size.width - std::max(dx, 0);
      for (int x = std::max(-dx, 0); x < end; ++x) {
        const cv::Vec2f sum = here[x] + there[x + dx];
        const float across = ax * sum[1] - ay * sum[0];
        const float off = ridge[x + dx] != 0 ? 0.0F : static_cast<float>(kOffRidge);
        const float cost = per_length * (static_cast<float>(kLeast) + table.misfit(across) + off);
        row[x * kWireSteps + i] = static_cast<std::uint8_t>(cost + 0.5F);
      }
    }
  }
  return costs;
}

}  // namespace fathom
