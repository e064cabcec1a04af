#include "acquisition/live/clock_mapping.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {

namespace {

// Before so much time has passed, delays would pass for drift.
constexpr double kShortestBaseline_s = 5.0;

// Once the line has settled, an arrival so far below it was not early: the clock has moved.
constexpr double kSettled_s = 10.0;
constexpr double kStepOfSettled_s = 0.003;

// Two stamps of one device come in order but for this: several devices of a peer may be a little apart.
constexpr double kDisorder_s = 0.5;

// So many seconds in which everything is late, with so many stamps each, are no longer chance.
constexpr std::size_t kLateSeconds = 3;
constexpr int kStampsOfSecond = 3;

}  // namespace

void ClockMapping::restart(double device_s, double arrival_s) {
  device_origin_s_ = device_s;
  live_origin_s_ = arrival_s;
  last_device_s_ = device_s;
  seconds_.clear();
  level_s_ = 0.0;
  slope_ = 0.0;
  started_ = true;
}

void ClockMapping::note_jump(double by_s) {
  if (std::abs(by_s) < kSmallestJump_s) return;
  ++jumps_;
  last_jump_s_ = by_s;
}

double ClockMapping::map(double device_s, double arrival_s) {
  if (!started_) restart(device_s, arrival_s);
  Point point{device_s - device_origin_s_, (arrival_s - live_origin_s_) - (device_s - device_origin_s_)};
  const bool settled = seconds_.size() > 1 && arrival_s - seconds_.front().begin_s > kSettled_s;
  const double early_s = -above_line_s(point);
  if (early_s > (settled ? kStepOfSettled_s : kSmallestJump_s) || device_s < last_device_s_ - kDisorder_s ||
      has_fallen_back(point)) {
    // At this moment, not at this stamp: over an hour's jump the drift would count.
    note_jump(level_s_ + slope_ * (arrival_s - live_origin_s_) - point.offset_s);
    restart(device_s, arrival_s);
    point = {0.0, 0.0};
  }
  last_device_s_ = device_s;
  add(point, arrival_s);
  return arrival_s - std::max(above_line_s(point), 0.0);
}

bool ClockMapping::has_fallen_back(const Point& point) const {
  // The second that is just being filled and the ones before it are late; what was before them was not.
  if (seconds_.size() <= kLateSeconds) return false;
  const std::size_t before = seconds_.size() - kLateSeconds;
  double least_s = above_line_s(point);
  for (std::size_t i = before; i < seconds_.size(); ++i) {
    if (seconds_[i].count < kStampsOfSecond) return false;
    least_s = std::min(least_s, above_line_s(seconds_[i].earliest));
  }
  double usual_s = 0.0;
  for (std::size_t i = 0; i < before; ++i) usual_s += above_line_s(seconds_[i].earliest) / static_cast<double>(before);
  // Delays that are often long are long for three seconds now and then.
  return least_s > kStepOfSettled_s + 8.0 * usual_s;
}

void ClockMapping::add(const Point& point, double arrival_s) {
  bool changed = false;
  if (seconds_.empty() || arrival_s - seconds_.back().begin_s >= 1.0) {
    seconds_.push_back({point, arrival_s, 0});
    while (arrival_s - seconds_.front().begin_s > kWindow_s) seconds_.pop_front();
    changed = true;
  }
  Second& second = seconds_.back();
  ++second.count;
  // Within a second the earliest is the one farthest down, whatever the drift.
  if (above_line_s(point) < above_line_s(second.earliest)) {
    second.earliest = point;
    changed = true;
  }
  if (changed) fit();
}

void ClockMapping::fit() {
  // Lower hull, from the left; stamps that do not advance keep the lower point.
  std::vector<Point> hull;
  double mean_s = 0.0;
  for (const Second& second : seconds_) {
    const Point& next = second.earliest;
    mean_s += next.device_s / static_cast<double>(seconds_.size());
    while (hull.size() > 1) {
      const Point& a = hull[hull.size() - 2];
      const Point& b = hull.back();
      const double turn = (b.device_s - a.device_s) * (next.offset_s - a.offset_s) -
                          (b.offset_s - a.offset_s) * (next.device_s - a.device_s);
      if (turn > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(next);
  }
  slope_ = 0.0;
  if (hull.back().device_s - hull.front().device_s >= kShortestBaseline_s) {
    std::size_t right = 1;
    while (right + 1 < hull.size() && hull[right].device_s < mean_s) ++right;
    slope_ = (hull[right].offset_s - hull[right - 1].offset_s) / (hull[right].device_s - hull[right - 1].device_s);
    slope_ = std::clamp(slope_, -kMaxDrift, kMaxDrift);
  }
  level_s_ = std::numeric_limits<double>::infinity();
  for (const Point& point : hull) level_s_ = std::min(level_s_, point.offset_s - slope_ * point.device_s);
}

}  // namespace fathom
