#include "acquisition/live/frame_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/rigid.h"

namespace fathom {

namespace {

constexpr double kFuture_s = 0.1;            // a mapped stamp may run ahead of its arrival by the mapping's own error
constexpr double kPast_s = 10.0;             // no line is so slow
constexpr std::size_t kMostTransforms = 64;  // of a hostile peer; trackers have a dozen tools
constexpr double kStale_s = 1.0;             // a transform that has not come for so long is not waited for

// Why a pose that is said to be valid cannot be used; empty where it can.
const char* fault_of(const TrackerSample& sample) {
  if (!sample.pose.matrix.allFinite()) return "NOT_FINITE";
  const bool pixels = sample.transform.starts_with("Image");
  const bool affine = sample.pose.matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
  return affine && (pixels || is_rigid(sample.pose.matrix)) ? "" : "NOT_RIGID";
}

}  // namespace

bool StampCheck::accepts(double time_s, double arrival_s) {
  // NaN compares false.
  const bool possible = time_s <= arrival_s + kFuture_s && time_s >= arrival_s - kPast_s;
  if (!possible || (last_s_ && time_s <= *last_s_)) return false;
  last_s_ = time_s;
  return true;
}

FrameMatcher::Transform* FrameMatcher::transform(const std::string& name) {
  const auto found =
      std::find_if(transforms_.begin(), transforms_.end(), [&](const auto& t) { return t.name == name; });
  if (found != transforms_.end()) return &*found;
  if (transforms_.size() == kMostTransforms) return nullptr;
  transforms_.push_back({name, PoseInterpolator(options_.max_gap_s), {}, 0.0});
  return &transforms_.back();
}

bool FrameMatcher::add(TrackerSample& sample) {
  const std::string fault = fault_of(sample);
  if (sample.pose.valid() && !fault.empty()) sample.pose.status = fault;
  if (fault == "NOT_FINITE") sample.pose.matrix.setIdentity();
  Transform* of = transform(sample.transform);
  if (of == nullptr || !of->stamps.accepts(sample.time_s, sample.arrival_s)) return false;
  of->arrival_s = sample.arrival_s;
  return of->poses.add(sample);
}

bool FrameMatcher::add(LiveFrame frame) {
  const bool accepted = stamps_.accepts(frame.time_s, frame.arrival_s);
  if (!accepted) {
    frame.time_s = frame.arrival_s;
    frame.status = "INVALID";
    frame.fields.emplace_back("TimeFault", "the device's time stamp cannot be");
  }
  if (!(frame.time_s > last_time_s_)) {
    // Behind a frame that was passed on at its arrival.
    frame.time_s = std::nextafter(last_time_s_, std::numeric_limits<double>::infinity());
  }
  last_time_s_ = frame.time_s;
  frames_.push_back({std::move(frame), accepted});
  return accepted;
}

PoseMoment FrameMatcher::moment_of(const LiveFrame& frame) const {
  return {frame.time_s, one_source_ ? frame.device_time_s : std::nullopt};
}

bool FrameMatcher::is_ready(const LiveFrame& frame, double now_s) const {
  if (!expected_ || now_s >= frame.arrival_s + options_.max_wait_s) return true;
  if (transforms_.empty()) return false;
  return std::all_of(transforms_.begin(), transforms_.end(), [&](const Transform& t) {
    return t.poses.reaches(moment_of(frame)) || now_s - t.arrival_s > kStale_s;
  });
}

bool FrameMatcher::is_required(const std::string& name) const {
  const auto& required = options_.required_transforms;
  if (!required.empty()) return std::find(required.begin(), required.end(), name) != required.end();
  const auto places_probe = [](const std::string& transform) {
    return transform.starts_with("Probe") || transform.starts_with("Reference");
  };
  const bool any =
      std::any_of(transforms_.begin(), transforms_.end(), [&](const auto& t) { return places_probe(t.name); });
  return any ? places_probe(name) : true;
}

void FrameMatcher::give_poses(TrackedFrame& tracked) const {
  std::size_t required = 0;
  bool valid = true;
  for (const Transform& t : transforms_) {
    tracked.poses.push_back({t.name, t.poses.at(moment_of(tracked.frame))});
    if (!is_required(t.name)) continue;
    ++required;
    valid = valid && tracked.poses.back().pose.valid();
  }
  tracked.tracked = valid && required > 0 && required >= options_.required_transforms.size();
}

SharedFrame FrameMatcher::next(double now_s) {
  if (frames_.empty() || !is_ready(frames_.front().frame, now_s)) return nullptr;
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = std::move(frames_.front().frame);
  const bool time_is_known = frames_.front().time_is_known;
  frames_.pop_front();
  give_poses(*tracked);
  if (!time_is_known) {
    for (NamedPose& pose : tracked->poses) pose.pose = {Eigen::Matrix4d::Identity(), "INVALID"};
    tracked->tracked = false;
  }
  return tracked;
}

std::optional<double> FrameMatcher::deadline_s() const {
  if (frames_.empty()) return std::nullopt;
  return frames_.front().frame.arrival_s + options_.max_wait_s;
}

}  // namespace fathom
