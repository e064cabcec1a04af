#include "segmentation/wire_search.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace fathom {

namespace {

constexpr std::uint8_t kStepMask = 0x07;
constexpr std::uint8_t kReached = 0x08;
constexpr std::uint8_t kSettled = 0x10;
constexpr std::uint8_t kOccupied = 0x20;
constexpr std::uint32_t kRing = 256;  // more than any step costs
constexpr std::uint32_t kDearest = 255;
constexpr int kFreeAroundStart = 2;  // pixels: the path so far ends there

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

WireSearch::WireSearch(const WireCosts& costs)
    : costs_(costs), cost_(at(costs.size.area())), state_(at(costs.size.area()), std::uint8_t{0}), ring_(kRing) {
  for (std::size_t i = 0; i < kWireSteps; ++i) step_[i] = kWireStepY[i] * costs.size.width + kWireStepX[i];
}

void WireSearch::start(cv::Point from, const std::vector<cv::Point>& occupied) {
  std::fill(state_.begin(), state_.end(), std::uint8_t{0});
  for (std::vector<int>& bucket : ring_) bucket.clear();
  for (const cv::Point& pixel : occupied) {
    if (std::max(std::abs(pixel.x - from.x), std::abs(pixel.y - from.y)) <= kFreeAroundStart) continue;
    state_[at(pixel.y * costs_.size.width + pixel.x)] = kOccupied;
  }
  start_ = from.y * costs_.size.width + from.x;
  cost_[at(start_)] = 0;
  state_[at(start_)] |= kReached;
  ring_[0].push_back(start_);
  level_ = 0;
  waiting_ = 1;
  settled_count_ = 0;
}

void WireSearch::relax(int pixel) {
  const std::uint8_t* steps = &costs_.steps[at(pixel) * kWireSteps];
  const std::uint32_t base = cost_[at(pixel)];
  for (int i = 0; i < kWireSteps; ++i) {
    if (steps[i] == 0) continue;
    const int next = pixel + step_[at(i)];
    std::uint8_t& state = state_[at(next)];
    if ((state & kSettled) != 0) continue;
    const std::uint32_t cost = base + ((state & kOccupied) != 0 ? kDearest : steps[i]);
    if ((state & kReached) != 0 && cost_[at(next)] <= cost) continue;
    cost_[at(next)] = cost;
    state = static_cast<std::uint8_t>((state & kOccupied) | kReached | i);
    ring_[cost % kRing].push_back(next);
    ++waiting_;
  }
}

void WireSearch::settle_until(int target) {
  while (waiting_ > 0 && (state_[at(target)] & kSettled) == 0) {
    std::vector<int>& bucket = ring_[level_ % kRing];
    if (bucket.empty()) {
      ++level_;
      continue;
    }
    const int pixel = bucket.back();
    bucket.pop_back();
    --waiting_;
    // Left behind where a cheaper way was found later.
    if ((state_[at(pixel)] & kSettled) != 0) continue;
    state_[at(pixel)] |= kSettled;
    ++settled_count_;
    relax(pixel);
  }
}

std::vector<cv::Point> WireSearch::path_to(cv::Point to) {
  const int width = costs_.size.width;
  int pixel = to.y * width + to.x;
  settle_until(pixel);
  std::vector<cv::Point> path;
  while (pixel != start_) {
    path.emplace_back(pixel % width, pixel / width);
    pixel -= step_[state_[at(pixel)] & kStepMask];
  }
  path.emplace_back(start_ % width, start_ / width);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace fathom
