#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace fathom {

/// Says once that a fault has begun, and once that it is over, however often it comes meanwhile.
class FaultRun {
 public:
  /// Returns whether the fault is new: say so.
  bool fault(double now_s) {
    last_s_ = now_s;
    ++count_;
    if (active_) return false;
    active_ = true;
    count_ = 1;
    return true;
  }

  /// Returns how often it came, once it has not come for a second: say that it is over.
  std::optional<std::uint64_t> fine(double now_s) {
    constexpr double kOver_s = 1.0;
    if (!active_ || now_s - last_s_ < kOver_s) return std::nullopt;
    active_ = false;
    return count_;
  }

 private:
  bool active_ = false;
  double last_s_ = 0.0;
  std::uint64_t count_ = 0;
};

}  // namespace fathom
