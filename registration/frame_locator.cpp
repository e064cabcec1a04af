#include "registration/frame_locator.h"

#include <algorithm>

#include "core/numbers.h"

namespace fathom {

namespace {

std::vector<double> increasing_times(const Recording& recording) {
  std::vector<double> times;
  for (const FrameHeader& frame : recording.header().frames) {
    const std::string here = " at frame " + std::to_string(times.size());
    if (!frame.time_s) {
      throw Error(recording.name() + ": has no time stamp" + here + ", so the calibration's latency cannot be applied");
    }
    if (!times.empty() && *frame.time_s <= times.back()) {
      throw Error(recording.name() + ": time does not increase" + here +
                  ", so the calibration's latency cannot be applied; split the recording there");
    }
    times.push_back(*frame.time_s);
  }
  return times;
}

// The probe's pose at `time`, between the two samples around it.
std::optional<Eigen::Isometry3d> pose_at(double time, const std::vector<double>& times,
                                         const std::vector<std::optional<Eigen::Isometry3d>>& poses) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - times.begin());
  if (times[i] == time) return poses[i];
  if (i == 0 || times[i] - times[i - 1] > kMaxPoseGap_s || !poses[i - 1] || !poses[i]) return std::nullopt;
  const double t = (time - times[i - 1]) / (times[i] - times[i - 1]);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(poses[i - 1]->linear()).slerp(t, Eigen::Quaterniond(poses[i]->linear()));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn.toRotationMatrix();
  pose.translation() = (1.0 - t) * poses[i - 1]->translation() + t * poses[i]->translation();
  return pose;
}

FrameNames with_defaults(FrameNames names, const Calibration& calibration) {
  if (!names.probe) names.probe = calibration.probe_frame;
  if (!names.reference) names.reference = calibration.reference_frame;
  return names;
}

}  // namespace

FrameLocator::FrameLocator(const Recording& recording, const Calibration& calibration, const FrameNames& names)
    : recording_name_(recording.name()), probe_from_image_(calibration.probe_from_image) {
  const RecordingHeader& header = recording.header();
  if (calibration.image_size && header.has_images() &&
      *calibration.image_size != cv::Size(header.width, header.height)) {
    throw Error(recording.name() + ": its images are " + std::to_string(header.width) + "x" +
                std::to_string(header.height) + ", the calibration is for " +
                std::to_string(calibration.image_size->width) + "x" + std::to_string(calibration.image_size->height) +
                "; use the calibration of this depth and image size");
  }
  const PoseChain chain = find_pose_chain(recording, with_defaults(names, calibration));
  probe_frame_ = chain.probe;
  reference_frame_ = chain.reference;

  std::vector<std::optional<Eigen::Isometry3d>> poses;
  poses.reserve(header.frames.size());
  for (int frame = 0; frame < header.frame_count(); ++frame) {
    poses.push_back(reference_from_probe(recording, chain, frame));
  }
  if (calibration.latency_s == 0.0) {
    reference_from_probe_ = std::move(poses);
    return;
  }
  const std::vector<double> times = increasing_times(recording);
  reference_from_probe_.reserve(times.size());
  for (const double time : times) reference_from_probe_.push_back(pose_at(time + calibration.latency_s, times, poses));
}

std::optional<Eigen::Affine3d> FrameLocator::reference_from_image(int frame) const {
  const auto& pose = reference_from_probe_.at(static_cast<std::size_t>(frame));
  if (!pose) return std::nullopt;
  return *pose * probe_from_image_;
}

}  // namespace fathom
