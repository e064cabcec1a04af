#pragma once

#include <cstdint>
#include <string>

#include "acquisition/live/live_source.h"

namespace fathom {

/// Faults of what a device sends, told to a listener as events: the first at once, then not more often than every
/// kPause_s, with how many there were since, so that a flood of faults is no flood of events.
class FaultLog {
 public:
  static constexpr double kPause_s = 2.0;

  void add(LiveListener& listener, const std::string& source, const std::string& fault);
  /// Tells what was held back, when its time has come; or now.
  void tell_due(LiveListener& listener, const std::string& source);
  void tell_rest(LiveListener& listener, const std::string& source);

  std::uint64_t count() const { return count_; }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t untold_ = 0;
  std::string last_;
  double next_s_ = 0.0;
};

}  // namespace fathom
