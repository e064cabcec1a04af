#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "core/random.h"
#include "registration/spatial_calibration_model.h"

namespace fathom {

/// A pose anywhere within 2 m, turned in any direction.
inline Eigen::Isometry3d random_pose(Random& random) {
  const auto vector = [&random] { return Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(random.uniform(-3.1, 3.1), vector().normalized()).toRotationMatrix();
  pose.translation() = 1000.0 * vector();
  return pose;
}

/// A pose as a tracker with Gaussian errors reports it: of the place, and about the probe's own axes.
inline Eigen::Isometry3d trembling(Eigen::Isometry3d pose, double mm, double rad, Random& random) {
  const auto vector = [&random] { return Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
  if (mm > 0.0) pose.translation() += mm * vector();
  const Eigen::Vector3d turn = rad > 0.0 ? Eigen::Vector3d(rad * vector()) : Eigen::Vector3d::Zero();
  if (turn.norm() > 0.0) pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  return pose;
}

/// Where two calibrations put the corners of the image, farthest apart.
inline double farthest_mm(const SpatialState& a, const SpatialState& b, double width_px, double height_px) {
  double farthest = 0.0;
  for (const double x : {0.0, width_px}) {
    for (const double y : {0.0, height_px}) {
      const Eigen::Vector3d pixel(x, y, 0.0);
      farthest = std::max(farthest, (a.probe_from_image() * pixel - b.probe_from_image() * pixel).norm());
    }
  }
  return farthest;
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
