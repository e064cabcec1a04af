#include "tests/acquisition/live/peer_frames.h"

#include <cstdio>

#include <Eigen/Geometry>

#include "acquisition/rigid.h"
#include "core/random.h"

namespace fathom {

namespace {
constexpr int kShift = 61;  // of the noise, from frame to frame
constexpr int kShifts = 1000;
}  // namespace

PeerFrames::PeerFrames(const std::string& what) {
  if (std::sscanf(what.c_str(), "%dx%d", &size_.width, &size_.height) != 2) {
    recording_ = open_recording(what);
    return;
  }
  Random random(1);
  noise_.resize(static_cast<std::size_t>(size_.area() + kShift * kShifts));
  for (std::uint8_t& value : noise_) value = static_cast<std::uint8_t>(random.uniform(0.0, 256.0));
}

cv::Mat PeerFrames::image(int frame) const {
  if (recording_) return recording_->image(frame % recording_->header().frame_count());
  // A view of the noise: only read.
  return {size_.height, size_.width, CV_8UC1, const_cast<std::uint8_t*>(noise_.data()) + kShift * (frame % kShifts)};
}

std::vector<PeerFrames::NamedMatrix> PeerFrames::poses(int frame) const {
  std::vector<NamedMatrix> poses;
  if (recording_) {
    const RecordingHeader& header = recording_->header();
    const FrameHeader& stored = header.frames[static_cast<std::size_t>(frame % header.frame_count())];
    for (std::size_t t = 0; t < header.transforms.size(); ++t) {
      const auto& pose = stored.poses[t];
      if (pose && pose->valid() && is_rigid(pose->matrix)) poses.push_back({header.transforms[t], pose->matrix});
    }
    return poses;
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.01 * frame, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  pose.pretranslate(Eigen::Vector3d(0.1 * frame, -7.0 / 3.0, 1e3 / 7.0));
  poses.push_back({"ProbeToTracker", pose.matrix()});
  return poses;
}

}  // namespace fathom
