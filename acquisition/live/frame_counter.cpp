#include "acquisition/live/frame_counter.h"

#include <cmath>

#include "core/statistics.h"

namespace fathom {

namespace {

constexpr std::size_t kIntervals = 31;
constexpr std::size_t kFewestIntervals = 3;
constexpr double kLongestCut_s = 3600.0;  // of a longer one nobody wants to know frames

// By the device's clock, unless it was set meanwhile.
double between_s(const FrameCounter::Time& from, const FrameCounter::Time& to) {
  const double arrival_s = to.arrival_s - from.arrival_s;
  if (!from.device_s || !to.device_s) return arrival_s;
  const double device_s = *to.device_s - *from.device_s;
  constexpr double kPlausible_s = 2.0;
  return std::abs(device_s - arrival_s) < kPlausible_s ? device_s : arrival_s;
}

}  // namespace

std::uint64_t FrameCounter::next(const Time& time) {
  if (last_) {
    const double interval_s = between_s(*last_, time);
    if (interval_s > 0.0) intervals_s_.push_back(interval_s);
    if (intervals_s_.size() > kIntervals) intervals_s_.pop_front();
  }
  last_ = time;
  return next_++;
}

std::optional<std::uint64_t> FrameCounter::lose_until(const Time& time) {
  if (!last_ || intervals_s_.size() < kFewestIntervals) return std::nullopt;
  const double cut_s = between_s(*last_, time);
  if (cut_s > kLongestCut_s) return std::nullopt;
  const double usual_s = median({intervals_s_.begin(), intervals_s_.end()});
  const double frames = std::round(cut_s / usual_s) - 1.0;
  last_.reset();  // the cut is no interval
  if (frames <= 0.0) return 0;
  next_ += static_cast<std::uint64_t>(frames);
  return static_cast<std::uint64_t>(frames);
}

}  // namespace fathom
