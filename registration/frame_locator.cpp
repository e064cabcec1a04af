#include "registration/frame_locator.h"

#include "registration/probe_poses.h"

namespace fathom {

namespace {

void require_increasing_times(const Recording& recording) {
  std::optional<double> before;
  for (int frame = 0; frame < recording.header().frame_count(); ++frame) {
    const auto& time = recording.header().frames[static_cast<std::size_t>(frame)].time_s;
    const std::string here = " at frame " + std::to_string(frame);
    if (!time) {
      throw Error(recording.name() + ": has no time stamp" + here + ", so the calibration's latency cannot be applied");
    }
    if (before && *time <= *before) {
      throw Error(recording.name() + ": time does not increase" + here +
                  ", so the calibration's latency cannot be applied; split the recording there");
    }
    before = time;
  }
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

  const ProbePoses poses = probe_poses(recording, chain);
  if (calibration.latency_s == 0.0) {
    reference_from_probe_ = poses.poses();
    return;
  }
  require_increasing_times(recording);
  reference_from_probe_.reserve(header.frames.size());
  for (int frame = 0; frame < poses.frame_count(); ++frame) {
    const auto at = poses.at(frame, calibration.latency_s);
    reference_from_probe_.push_back(at && at->inside ? std::optional(at->reference_from_probe) : std::nullopt);
  }
}

std::optional<Eigen::Affine3d> FrameLocator::reference_from_image(int frame) const {
  const auto& pose = reference_from_probe_.at(static_cast<std::size_t>(frame));
  if (!pose) return std::nullopt;
  return *pose * probe_from_image_;
}

}  // namespace fathom
