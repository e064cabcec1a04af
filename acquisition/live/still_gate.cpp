#include "acquisition/live/still_gate.h"

#include <algorithm>
#include <numbers>

#include "acquisition/rigid.h"
#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

// A probe that has gone so many times the radius has left, whatever the hand's tremor.
constexpr double kHasLeft = 4.0;

const Pose* find_pose(const TrackedFrame& frame, const std::string& prefix) {
  const auto found = std::find_if(frame.poses.begin(), frame.poses.end(),
                                  [&](const NamedPose& pose) { return pose.transform.starts_with(prefix); });
  return found == frame.poses.end() ? nullptr : &found->pose;
}

bool is_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double radius_mm, double angle_deg) {
  const double angle_rad = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
  return (a.translation() - b.translation()).norm() <= radius_mm && angle_rad <= angle_deg * std::numbers::pi / 180.0;
}

void require(double value, double low, double high, const std::string& name) {
  if (value >= low && value <= high) return;
  throw Error(name + " is " + format_real(value) + "; choose one from " + format_real(low) + " to " +
              format_real(high));
}

}  // namespace

std::optional<Eigen::Isometry3d> probe_pose(const TrackedFrame& frame) {
  const Pose* probe = find_pose(frame, "ProbeTo");
  if (probe == nullptr && !frame.poses.empty()) probe = &frame.poses.front().pose;
  if (probe == nullptr || !probe->valid() || !is_rigid(probe->matrix)) return std::nullopt;
  const Eigen::Isometry3d tracker_from_probe = nearest_rigid(probe->matrix);
  const Pose* reference = find_pose(frame, "ReferenceToTracker");
  if (reference == nullptr || find_pose(frame, "ProbeToTracker") == nullptr) return tracker_from_probe;
  if (!reference->valid() || !is_rigid(reference->matrix)) return std::nullopt;
  return nearest_rigid(reference->matrix).inverse() * tracker_from_probe;
}

void HoldStillOptions::check() const {
  require(duration_s, 0.1, 60.0, "the time to hold the probe still (s)");
  require(radius_mm, 0.01, 100.0, "the distance within which the probe is still (mm)");
  require(angle_deg, 0.01, 90.0, "the angle within which the probe is still (degrees)");
}

bool StillDetector::add(double time_s, const std::optional<Eigen::Isometry3d>& pose) {
  if (!pose) {
    poses_.clear();
    return false;
  }
  const auto moved = [&](const At& at) { return !is_near(at.pose, *pose, options_.radius_mm, options_.angle_deg); };
  // What lies before the last pose that is too far away belongs to the motion.
  const auto last_far = std::find_if(poses_.rbegin(), poses_.rend(), moved);
  poses_.erase(poses_.begin(), last_far.base());
  poses_.push_back({time_s, *pose});
  // One older than the duration is enough to know.
  while (poses_.size() > 2 && time_s - poses_[1].time_s >= options_.duration_s) poses_.pop_front();
  return time_s - poses_.front().time_s >= options_.duration_s;
}

GateState StillGate::add(const TrackedFrame& frame) {
  if (state_ == GateState::kClosed) return state_;
  const std::optional<Eigen::Isometry3d> pose = frame.valid() ? probe_pose(frame) : std::nullopt;
  const bool still = detector_.add(frame.frame.time_s, pose);
  const bool left =
      start_ && pose && !is_near(*start_, *pose, kHasLeft * options_.radius_mm, kHasLeft * options_.angle_deg);
  switch (state_) {
    case GateState::kWaitingForStill:
      was_still_ = was_still_ && !left;
      if (still && !was_still_) {
        state_ = GateState::kReady;
        start_ = pose;
      }
      break;
    case GateState::kReady:
      if (left) state_ = GateState::kSweeping;
      break;
    case GateState::kSweeping:
      if (still) {
        state_ = GateState::kClosed;
        start_ = pose;
      }
      break;
    case GateState::kClosed:
      break;
  }
  return state_;
}

void StillGate::open_again() {
  was_still_ = state_ != GateState::kWaitingForStill && start_.has_value();
  state_ = GateState::kWaitingForStill;
}

}  // namespace fathom
