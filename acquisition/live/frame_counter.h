#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace fathom {

/// Numbers the frames of a device that does not number them itself, with gaps where some were lost.
class FrameCounter {
 public:
  /// When a frame was made, on the device's clock where it has one, and when it arrived.
  struct Time {
    std::optional<double> device_s;
    double arrival_s = 0.0;
  };

  /// The number of the next frame.
  std::uint64_t next(const Time& time);

  /// So many frames are known to have been lost.
  void lose(std::uint64_t frames) { next_ += frames; }

  /// The line was cut before the frame of `time`: how many frames were lost meanwhile, by the usual time between
  /// frames, are lost in the count too. Empty where there is no saying.
  std::optional<std::uint64_t> lose_until(const Time& time);

 private:
  std::uint64_t next_ = 0;
  std::optional<Time> last_;
  std::deque<double> intervals_s_;  // the latest
};

}  // namespace fathom
