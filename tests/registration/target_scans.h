#pragma once

#include <cmath>
#include <vector>

#include "core/random.h"
#include "registration/spatial_calibration_model.h"
#include "registration/wall_detection.h"
#include "tests/registration/poses.h"

namespace fathom {

/// How a floor or a point is scanned.
struct TargetScanning {
  double noise_px = 1.0;     ///< of a point on each axis; of both ends of a line across it
  double tracker_mm = 0.0;   ///< on each axis
  double tracker_rad = 0.0;  ///< about each axis
  double latency_s = 0.0;    ///< the tracker's stamps are late
  double skew = 0.0;
  double twist_rad = 1.2;   ///< amplitude of the turns about the long axis
  double tilt_rad = 0.45;   ///< of those forwards and sideways
  double height_mm = 12.0;  ///< of the way up and down
  int frames = 120;
};

struct TargetScan {
  SpatialState truth;
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times_s;
  std::vector<WallLine> lines;
  std::vector<SpotPoint> points;

  ProbePoses tracked() const { return {"scan.mha", poses, times_s}; }
};

inline constexpr int kScanWidth_px = 640;
inline constexpr int kScanHeight_px = 480;

/// A hand over a target: the image's middle, 20 mm below its top, sways and turns about a place.
class OverTarget {
 public:
  OverTarget(const TargetScanning& how, Random& random) : how_(how) {
    for (double& phase : phase_) phase = random.uniform(0.0, 6.3);
  }
  // z of the target is up, the image's y is down.
  Eigen::Isometry3d target_from_image(double t) const {
    Eigen::Matrix3d upright;
    upright << Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(how_.twist_rad * sway(0, 0.35, t), Eigen::Vector3d::UnitZ()).toRotationMatrix() *
                    upright *
                    (Eigen::AngleAxisd(how_.tilt_rad * sway(1, 0.62, t), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(how_.tilt_rad * sway(2, 0.85, t), Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
    pose.translation() =
        Eigen::Vector3d(10 * sway(3, 0.41, t), 10 * sway(4, 0.53, t), 30 + how_.height_mm * sway(5, 0.74, t)) -
        pose.linear() * Eigen::Vector3d(kMiddleMm, 10, 0);
    return pose;
  }
  // The same with a small target in the image's plane, in all its parts.
  Eigen::Isometry3d point_from_image(double t) const {
    Eigen::Isometry3d pose = target_from_image(t);
    pose.translation() =
        -(pose.linear() * Eigen::Vector3d(kMiddleMm + 18 * sway(3, 0.41, t), 22 + 15 * sway(5, 0.74, t), 0));
    return pose;
  }
  static constexpr double kMiddleMm = 25.6;

 private:
  double sway(std::size_t which, double hertz, double t) const { return std::sin(6.2832 * hertz * t + phase_[which]); }
  TargetScanning how_;
  std::array<double, 6> phase_{};
};

inline TargetScan scan_target(const TargetScanning& how, bool wall, Random& random) {
  TargetScan scan;
  scan.truth.translation_mm = Eigen::Vector3d(12, -45, 8);
  scan.truth.rotation = Eigen::AngleAxisd(1.7, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
  scan.truth.log_sx = std::log(0.08);
  scan.truth.log_sy = std::log(0.074);
  scan.truth.skew = how.skew;
  scan.truth.latency_s = how.latency_s;
  scan.truth.reference_from_phantom = random_pose(random);
  const OverTarget hand(how, random);
  // Rigid: pixels are turned into image millimetres below.
  Eigen::Isometry3d probe_from_image = Eigen::Isometry3d::Identity();
  probe_from_image.linear() = scan.truth.rotation.toRotationMatrix();
  probe_from_image.translation() = scan.truth.translation_mm;
  const auto px_from_mm = [&](double x, double y) { return Eigen::Vector2d((x - how.skew * y) / 0.08, y / 0.074); };
  for (int frame = 0; frame < how.frames; ++frame) {
    const double t = 0.06 * frame;
    scan.times_s.push_back(100.0 + t);
    const auto image_at = [&](double time) {
      return wall ? hand.target_from_image(time) : hand.point_from_image(time);
    };
    Eigen::Isometry3d pose =
        scan.truth.reference_from_phantom * image_at(t - how.latency_s) * probe_from_image.inverse();
    pose = trembling(pose, how.tracker_mm, how.tracker_rad, random);
    scan.poses.emplace_back(pose);
    const Eigen::Isometry3d target_from_image = image_at(t);
    if (wall) {
      // Height of image (x, y): h + gx x + gy y = 0, at 10 columns' spread about the middle.
      const Eigen::RowVector3d height = target_from_image.linear().row(2);
      const auto depth_at = [&](double x) {
        return -(target_from_image.translation().z() + height.x() * x) / height.y();
      };
      constexpr double kSpreadMm = 12.0;
      std::array<Eigen::Vector2d, 2> ends;
      for (std::size_t i = 0; i < 2; ++i) {
        const double x = OverTarget::kMiddleMm + (i == 0 ? -kSpreadMm : kSpreadMm);
        ends[i] = px_from_mm(x, depth_at(x)) + Eigen::Vector2d(0.0, how.noise_px * random.normal());
      }
      WallLine line;
      line.frame = frame;
      line.point_px = 0.5 * (ends[0] + ends[1]);
      line.direction = (ends[1] - ends[0]).normalized();
      line.reach_px = 0.5 * (ends[1] - ends[0]).norm();
      scan.lines.push_back(line);
    } else {
      const Eigen::Vector3d place = target_from_image.inverse() * Eigen::Vector3d::Zero();
      scan.points.push_back(
          {frame, px_from_mm(place.x(), place.y()) + how.noise_px * Eigen::Vector2d(random.normal(), random.normal())});
    }
  }
  return scan;
}

}  // namespace fathom
