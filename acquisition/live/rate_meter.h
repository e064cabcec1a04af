#pragma once

#include <cstddef>
#include <deque>

namespace fathom {

/// How many a second, over the last two seconds.
class RateMeter {
 public:
  void count(double now_s) {
    times_s_.push_back(now_s);
    forget(now_s);
  }

  double rate_hz(double now_s) const {
    std::size_t recent = 0;
    for (const double time : times_s_) recent += now_s - time < kWindow_s ? 1 : 0;
    if (recent < 2) return 0.0;
    const double first = times_s_[times_s_.size() - recent];
    return static_cast<double>(recent - 1) / (times_s_.back() > first ? times_s_.back() - first : kWindow_s);
  }

 private:
  static constexpr double kWindow_s = 2.0;
  static constexpr std::size_t kMost = 20000;  // no device is so fast; a flood takes no more memory

  void forget(double now_s) {
    while (now_s - times_s_.front() >= kWindow_s || times_s_.size() > kMost) times_s_.pop_front();
  }

  std::deque<double> times_s_;
};

}  // namespace fathom
