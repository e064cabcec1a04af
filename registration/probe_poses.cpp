#include "registration/probe_poses.h"

#include <algorithm>
#include <cassert>

#include "core/statistics.h"

namespace fathom {

ProbePoses::ProbePoses(std::string recording, std::vector<std::optional<Eigen::Isometry3d>> reference_from_probe,
                       std::vector<double> times_s)
    : recording_(std::move(recording)), poses_(std::move(reference_from_probe)), times_s_(std::move(times_s)) {
  assert(times_s_.empty() || times_s_.size() == poses_.size());
  for (std::size_t i = 0; i + 1 < times_s_.size(); ++i) {
    const double duration = times_s_[i + 1] - times_s_[i];
    if (!poses_[i] || !poses_[i + 1] || duration > kMaxPoseGap_s) continue;
    const Eigen::AngleAxisd turn(poses_[i]->linear().transpose() * poses_[i + 1]->linear());
    steps_.push_back({times_s_[i], duration, static_cast<int>(i), turn.angle() * turn.axis()});
  }
}

ProbePoses ProbePoses::evenly_smoothed() const {
  ProbePoses smoothed = *this;
  std::vector<double> durations;
  for (const Step& step : steps_) durations.push_back(step.duration_s);
  smoothed.smoothing_s_ = median(std::move(durations)) / 3.0;
  return smoothed;
}

std::optional<ProbePoses::At> ProbePoses::at(int frame, double latency_s) const {
  if (smoothing_s_ == 0.0) return straight_at(frame, latency_s);
  const auto before = straight_at(frame, latency_s - smoothing_s_);
  const auto after = straight_at(frame, latency_s + smoothing_s_);
  if (!before || !after) return std::nullopt;
  At mean;
  const Eigen::Quaterniond turn(before->reference_from_probe.linear());
  mean.reference_from_probe.linear() =
      turn.slerp(0.5, Eigen::Quaterniond(after->reference_from_probe.linear())).toRotationMatrix();
  mean.reference_from_probe.translation() =
      0.5 * (before->reference_from_probe.translation() + after->reference_from_probe.translation());
  mean.velocity_mm_s = 0.5 * (before->velocity_mm_s + after->velocity_mm_s);
  mean.turning_rad_s = 0.5 * (before->turning_rad_s + after->turning_rad_s);
  mean.inside = before->inside && after->inside;
  return mean;
}

std::optional<ProbePoses::At> ProbePoses::straight_at(int frame, double latency_s) const {
  const auto& own = poses_.at(static_cast<std::size_t>(frame));
  if (steps_.empty()) {
    if (!own) return std::nullopt;
    return At{*own, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), latency_s == 0.0};
  }
  const double time = times_s_[static_cast<std::size_t>(frame)] + latency_s;
  auto after = std::upper_bound(steps_.begin(), steps_.end(), time,
                                [](double value, const Step& step) { return value < step.start_s; });
  if (after != steps_.begin()) --after;
  // In a gap, the nearer of the steps on its sides.
  const auto next = after + 1;
  if (next != steps_.end() && time > after->start_s + after->duration_s &&
      next->start_s - time < time - after->start_s - after->duration_s) {
    after = next;
  }
  const double part = (time - after->start_s) / after->duration_s;
  const Eigen::Isometry3d& first = *poses_[static_cast<std::size_t>(after->first)];
  const Eigen::Isometry3d& last = *poses_[static_cast<std::size_t>(after->first) + 1];
  At at;
  const double angle = after->turn_rad.norm();
  at.reference_from_probe.linear() =
      angle > 0.0 ? first.linear() * Eigen::AngleAxisd(part * angle, after->turn_rad / angle).toRotationMatrix()
                  : Eigen::Matrix3d(first.linear());
  at.reference_from_probe.translation() = (1.0 - part) * first.translation() + part * last.translation();
  at.velocity_mm_s = (last.translation() - first.translation()) / after->duration_s;
  at.turning_rad_s = after->turn_rad / after->duration_s;
  constexpr double kRounding = 1e-6;  // of a step: stamps of 2588.141729 s keep no more
  at.inside = part >= -kRounding && part <= 1.0 + kRounding;
  if (!at.inside) {  // a single valid pose among lost ones
    const auto stamp = std::lower_bound(times_s_.begin(), times_s_.end(), time);
    if (stamp == times_s_.end() || *stamp != time) return at;
    const auto& alone = poses_[static_cast<std::size_t>(stamp - times_s_.begin())];
    if (alone) at = {*alone, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), true};
  }
  return at;
}

int ProbePoses::valid_count() const {
  return static_cast<int>(std::count_if(poses_.begin(), poses_.end(), [](const auto& p) { return p.has_value(); }));
}

ProbePoses probe_poses(const Recording& recording, const PoseChain& chain) {
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times;
  bool usable = true;
  for (int frame = 0; frame < recording.header().frame_count(); ++frame) {
    poses.push_back(reference_from_probe(recording, chain, frame));
    const auto& time = recording.header().frames[static_cast<std::size_t>(frame)].time_s;
    usable = usable && time && (times.empty() || *time > times.back());
    times.push_back(time.value_or(0.0));
  }
  if (!usable) times.clear();
  return {recording.name(), std::move(poses), std::move(times)};
}

}  // namespace fathom
