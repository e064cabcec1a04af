#pragma once

#include <deque>
#include <optional>
#include <vector>

namespace fathom {

/// Maps a device's time stamps to live_clock_s(), from stamps and the moments at which they arrived.
///
/// What is stamped arrives late, by a delay that varies and is never negative. So the device's clock, as a straight
/// line over the live one, lies below all arrivals and touches those that were not held up: of all lines below the
/// earliest arrivals of each second of the last kWindow_s, it is the one that is closest to them on average (an edge of
/// their lower convex hull; Moon, Skelly and Towsley 1999, "Estimation and removal of clock skew from network delay
/// measurements"). The shortest delay that the line has cannot be told from a shift between the clocks: it is taken
/// as none.
///
/// A clock that jumps, seen as stamps that arrive before they were made, as stamps that go back, or as seconds in which
/// everything seems late by the same amount, starts the line anew.
class ClockMapping {
 public:
  static constexpr double kWindow_s = 60.0;
  static constexpr double kMaxDrift = 500e-6;      ///< the worst of quartz clocks, twice
  static constexpr double kSmallestJump_s = 0.05;  ///< what jumps() counts; smaller steps are followed, and not counted

  /// When a stamp was made, on live_clock_s(): never after it arrived. `arrival_s` never goes back. Both are finite.
  double map(double device_s, double arrival_s);

  /// How often the device's clock jumped, and by how much it did the last time: positive where it was set forward.
  int jumps() const { return jumps_; }
  double last_jump_s() const { return last_jump_s_; }

  /// How much faster the live clock runs than the device's, 1e-6 for a part per million.
  double drift() const { return slope_; }

 private:
  struct Point {
    double device_s;  // since the line was started
    double offset_s;  // live minus device, since the line was started
  };
  struct Second {
    Point earliest;      // least held up
    double begin_s = 0;  // arrival
    int count = 0;
  };

  void restart(double device_s, double arrival_s);
  void note_jump(double by_s);
  bool has_fallen_back(const Point& point) const;
  void add(const Point& point, double arrival_s);
  void fit();
  double above_line_s(const Point& point) const { return point.offset_s - level_s_ - slope_ * point.device_s; }

  bool started_ = false;
  double device_origin_s_ = 0.0;
  double live_origin_s_ = 0.0;
  double last_device_s_ = 0.0;
  std::deque<Second> seconds_;
  double level_s_ = 0.0;  // the line: offset_s = level_s_ + slope_ * device_s
  double slope_ = 0.0;
  int jumps_ = 0;
  double last_jump_s_ = 0.0;
};

}  // namespace fathom
