#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "acquisition/recording.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

// A ball scanned by planes anywhere, outlined exactly.
namespace fathom {

/// Frames whose images lie where the poses say, pixels of `pixel_mm`.
inline FrameLocator scan_of(const std::vector<Eigen::Isometry3d>& reference_from_plane, double pixel_mm,
                            std::vector<int> lost = {}) {
  RecordingHeader header;
  header.transforms = {"ProbeToTracker"};
  for (std::size_t i = 0; i < reference_from_plane.size(); ++i) {
    FrameHeader frame;
    const bool is_lost = std::find(lost.begin(), lost.end(), static_cast<int>(i)) != lost.end();
    frame.poses.emplace_back(Pose{reference_from_plane[i].matrix(), is_lost ? "INVALID" : "OK"});
    header.frames.push_back(frame);
  }
  Calibration calibration;
  calibration.probe_from_image.linear() *= pixel_mm;
  return FrameLocator(MemoryRecording("scan.mha", header, {}), calibration);
}

/// Where `frame` cuts the ball: a circle of `points` points, or nothing.
inline std::vector<Contour> ball_contour(const FrameLocator& locator, int frame, const Eigen::Vector3d& centre_mm,
                                         double radius_mm, int points = 120) {
  const Eigen::Affine3d reference_from_image = *locator.reference_from_image(frame);
  const Eigen::Vector3d centre_px = reference_from_image.inverse() * centre_mm;
  const double pixel_mm = reference_from_image.linear().col(0).norm();
  const double off_mm = centre_px.z() * pixel_mm;
  const double square = radius_mm * radius_mm - off_mm * off_mm;
  if (square <= 0.0) return {};
  Contour contour;
  contour.frame = frame;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    contour.points_px.emplace_back(centre_px.x() + std::sqrt(square) / pixel_mm * std::cos(angle),
                                   centre_px.y() + std::sqrt(square) / pixel_mm * std::sin(angle));
  }
  return {contour};
}

/// The ball outlined on every `every`-th frame that cuts it.
inline Structure ball(const FrameLocator& locator, const Eigen::Vector3d& centre_mm, double radius_mm, int every = 1) {
  Structure structure;
  structure.name = "ball";
  for (int frame = 0; frame < locator.frame_count(); frame += every) {
    if (!locator.reference_from_image(frame)) continue;
    for (const Contour& contour : ball_contour(locator, frame, centre_mm, radius_mm)) {
      structure.contours.push_back(contour);
    }
  }
  return structure;
}

/// Planes at `places_mm` along z, each turned about x and y by the sweep's place times these angles per millimetre.
inline std::vector<Eigen::Isometry3d> turning_sweep(const std::vector<double>& places_mm, double x_rad_per_mm = 0.0,
                                                    double y_rad_per_mm = 0.0) {
  std::vector<Eigen::Isometry3d> poses;
  for (const double z : places_mm) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(0.0, 0.0, z));
    pose.rotate(Eigen::AngleAxisd(x_rad_per_mm * z, Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(y_rad_per_mm * z, Eigen::Vector3d::UnitY()));
    poses.push_back(pose);
  }
  return poses;
}

inline std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(first + (last - first) * i / (count - 1));
  return places;
}

}  // namespace fathom
