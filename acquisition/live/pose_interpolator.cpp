#include "acquisition/live/pose_interpolator.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "acquisition/rigid.h"

namespace fathom {

namespace {

constexpr double kRemembered_s = 10.0;
constexpr std::size_t kMostSamples = 20000;  // of a tracker at 1 kHz: more than is remembered

Pose without_place(std::string status) { return {Eigen::Matrix4d::Identity(), std::move(status)}; }

Pose value_of(const TrackerSample& sample) {
  return sample.pose.valid() ? sample.pose : without_place(sample.pose.status);
}

}  // namespace

Eigen::Matrix4d interpolated(const Eigen::Matrix4d& from, const Eigen::Matrix4d& to, double share) {
  if (from == to) return from;
  Eigen::Matrix4d between = (1.0 - share) * from + share * to;
  if (!is_rigid(from) || !is_rigid(to)) return between;
  const Eigen::Quaterniond start(nearest_rigid(from).linear());
  const Eigen::Quaterniond end(nearest_rigid(to).linear());
  between.topLeftCorner<3, 3>() = start.slerp(share, end).toRotationMatrix();
  return between;
}

bool PoseInterpolator::add(const TrackerSample& sample) {
  if (!samples_.empty() && !(sample.time_s > samples_.back().time_s)) return false;
  samples_.push_back(sample);
  while (samples_.size() > kMostSamples || sample.time_s - samples_.front().time_s > kRemembered_s) {
    samples_.pop_front();
  }
  return true;
}

const TrackerSample* PoseInterpolator::of_device_time(const PoseMoment& moment) const {
  if (!moment.device_time_s) return nullptr;
  const auto found = std::find_if(samples_.rbegin(), samples_.rend(), [&](const TrackerSample& sample) {
    // A device that starts again counts through the same stamps again: then our own clock tells them apart.
    return sample.device_time_s == moment.device_time_s && std::abs(sample.time_s - moment.time_s) <= max_gap_s_;
  });
  return found == samples_.rend() ? nullptr : &*found;
}

bool PoseInterpolator::reaches(const PoseMoment& moment) const {
  return !samples_.empty() && (samples_.back().time_s >= moment.time_s || of_device_time(moment) != nullptr);
}

Pose PoseInterpolator::at(const PoseMoment& moment) const {
  if (const TrackerSample* same = of_device_time(moment)) return value_of(*same);
  const auto behind = std::lower_bound(samples_.begin(), samples_.end(), moment.time_s,
                                       [](const TrackerSample& sample, double time) { return sample.time_s < time; });
  if (behind != samples_.end() && behind->time_s == moment.time_s) return value_of(*behind);
  if (behind == samples_.end() || behind == samples_.begin()) return without_place("MISSING");
  const auto before = behind - 1;
  for (const TrackerSample& neighbour : {*before, *behind}) {
    if (!neighbour.pose.valid()) return without_place(neighbour.pose.status);
  }
  const double gap_s = behind->time_s - before->time_s;
  if (gap_s > max_gap_s_) return without_place("MISSING");
  return {interpolated(before->pose.matrix, behind->pose.matrix, (moment.time_s - before->time_s) / gap_s), "OK"};
}

}  // namespace fathom
