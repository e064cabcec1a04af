#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "core/random.h"

namespace fathom {

/// A pose anywhere within 2 m, turned in any direction.
inline Eigen::Isometry3d random_pose(Random& random) {
  const auto vector = [&random] { return Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(random.uniform(-3.1, 3.1), vector().normalized()).toRotationMatrix();
  pose.translation() = 1000.0 * vector();
  return pose;
}

/// A recording in memory whose header a test may change.
class EditableRecording : public MemoryRecording {
 public:
  using MemoryRecording::MemoryRecording;
  RecordingHeader& edit() { return header_; }
};

/// Poses only, a row for each frame, stamped 0.04 s apart from 10 s on.
inline std::unique_ptr<EditableRecording> recording_of_poses(
    std::vector<std::string> transforms, const std::vector<std::vector<Eigen::Isometry3d>>& poses,
    std::vector<std::pair<std::string, std::string>> fields = {}) {
  RecordingHeader header;
  header.transforms = std::move(transforms);
  header.fields = std::move(fields);
  for (const auto& row : poses) {
    FrameHeader frame;
    frame.time_s = 10.0 + 0.04 * static_cast<double>(header.frames.size());
    for (const Eigen::Isometry3d& pose : row) frame.poses.push_back(Pose{pose.matrix(), "OK"});
    header.frames.push_back(std::move(frame));
  }
  return std::make_unique<EditableRecording>("test.mha", std::move(header), std::vector<cv::Mat>{});
}

}  // namespace fathom
