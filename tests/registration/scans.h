#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "registration/frame_locator.h"
#include "tests/registration/poses.h"

namespace fathom {

/// A recording in memory whose frames lie where a test wants them.
struct PlacedScan {
  std::unique_ptr<EditableRecording> recording;
  std::unique_ptr<FrameLocator> locator;

  Eigen::Affine3d map(int frame) const { return *locator->reference_from_image(frame); }
};

/// `grey` gives the value of a frame at a place in mm; it is rounded and kept in the type's range.
using GreyAt = std::function<double(int frame, const Eigen::Vector3d& place_mm)>;

inline PlacedScan scan_of(const std::vector<Eigen::Isometry3d>& poses, cv::Size size, const Eigen::Vector2d& pixel_mm,
                          int type, const GreyAt& grey) {
  RecordingHeader header;
  header.width = size.width;
  header.height = size.height;
  header.pixel_type = type;
  header.transforms = {"ProbeToTracker"};
  Calibration calibration;
  calibration.probe_from_image.linear() = Eigen::Vector3d(pixel_mm.x(), pixel_mm.y(), 1.0).asDiagonal();
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    FrameHeader frame;
    frame.time_s = 0.04 * static_cast<double>(i);
    frame.poses = {Pose{poses[i].matrix(), "OK"}};
    header.frames.push_back(frame);
    cv::Mat values(size, CV_64F);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Eigen::Vector3d place_mm = poses[i] * (calibration.probe_from_image * Eigen::Vector3d(x, y, 0.0));
        values.at<double>(y, x) = grey(static_cast<int>(i), place_mm);
      }
    }
    cv::Mat image;
    values.convertTo(image, type);
    images.push_back(image);
  }
  PlacedScan scan;
  scan.recording = std::make_unique<EditableRecording>("test.mha", header, images);
  scan.locator = std::make_unique<FrameLocator>(*scan.recording, calibration);
  return scan;
}

/// Poses along z, `step_mm` apart, shifted and turned at random.
inline std::vector<Eigen::Isometry3d> trembling_poses(Random& random, int count, double step_mm, double shift_mm,
                                                      double turn_rad) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const auto any = [&random](double reach) { return random.uniform(-reach, reach); };
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(any(shift_mm), any(shift_mm), any(shift_mm) + step_mm * i);
    pose.rotate(Eigen::AngleAxisd(any(turn_rad), Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(any(turn_rad), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(any(turn_rad), Eigen::Vector3d::UnitZ()));
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace fathom
