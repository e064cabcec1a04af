#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "registration/spatial_calibration_model.h"
#include "registration/wire_phantom.h"
#include "tests/registration/poses.h"

namespace fathom {

/// Points of wires as a probe sees them that sways over the phantom.
struct WireScan {
  WirePhantom phantom;
  SpatialState truth;
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times_s;
  std::vector<WirePoint> points;

  ProbePoses tracked() const { return {"scan.mha", poses, times_s}; }
};

inline WirePhantom three_ns() {
  WirePhantom phantom;
  const auto add = [&phantom](double z, double front, double back) {
    const std::string n = std::to_string(phantom.patterns.size());
    phantom.patterns.push_back({Wire{n + "a", {0, 0, z}, {0, 40, z}}, Wire{n + "b", {front, 0, z}, {back, 40, z}},
                                Wire{n + "c", {30, 0, z}, {30, 40, z}}});
  };
  add(20, 27, 3);
  add(10, 3, 27);
  add(0, 24, 6);
  return phantom;
}

/// A probe that sways over the phantom and turns about all axes; the tracker's stamps lag by `latency_s`, its poses
/// have errors on each axis. At a `pace` of 1 it moves by 16 mm/s at most.
inline WireScan scan_wires(Random& random, double noise_px, double latency_s, double tracker_mm = 0.0,
                           double tracker_rad = 0.0, double pace = 1.0) {
  WireScan scan;
  scan.phantom = three_ns();
  scan.phantom.reference_from_phantom = random_pose(random);
  scan.truth.translation_mm = Eigen::Vector3d(12, -45, 8);
  scan.truth.rotation = Eigen::AngleAxisd(1.7, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
  scan.truth.log_sx = std::log(0.08);
  scan.truth.log_sy = std::log(0.074);
  scan.truth.latency_s = latency_s;
  scan.truth.reference_from_phantom = *scan.phantom.reference_from_phantom;
  // Rough: the image's x runs along the phantom's, its y down, so that its normal is along the wires.
  Eigen::Matrix3d upright;
  upright << Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY();
  Eigen::Isometry3d probe_from_image = Eigen::Isometry3d::Identity();
  probe_from_image.linear() = scan.truth.rotation.toRotationMatrix();
  probe_from_image.translation() = scan.truth.translation_mm;
  const auto reference_from_probe = [&](double time) {
    const double t = pace * time;
    Eigen::Isometry3d phantom_from_image = Eigen::Isometry3d::Identity();
    phantom_from_image.linear() = upright * (Eigen::AngleAxisd(0.25 * std::sin(0.9 * t), Eigen::Vector3d::UnitX()) *
                                             Eigen::AngleAxisd(0.25 * std::sin(1.3 * t + 1), Eigen::Vector3d::UnitY()) *
                                             Eigen::AngleAxisd(0.25 * std::sin(1.1 * t + 2), Eigen::Vector3d::UnitZ()))
                                                .toRotationMatrix();
    phantom_from_image.translation() =
        Eigen::Vector3d(15, 20 + 8 * std::sin(2.0 * t), 30) - phantom_from_image.linear() * Eigen::Vector3d(32, 2, 0);
    return Eigen::Isometry3d(*scan.phantom.reference_from_phantom * phantom_from_image * probe_from_image.inverse());
  };
  constexpr int kFrames = 120;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double t = 0.05 * frame;
    scan.times_s.push_back(100.0 + t);
    scan.poses.push_back(trembling(reference_from_probe(t - latency_s), tracker_mm, tracker_rad, random));
    const Eigen::Isometry3d image_from_phantom =
        (scan.phantom.reference_from_phantom->inverse() * reference_from_probe(t) * probe_from_image).inverse();
    for (std::size_t p = 0; p < scan.phantom.patterns.size(); ++p) {
      for (std::size_t w = 0; w < 3; ++w) {
        const Eigen::Vector3d a = image_from_phantom * scan.phantom.patterns[p][w].front;
        const Eigen::Vector3d b = image_from_phantom * scan.phantom.patterns[p][w].back;
        const Eigen::Vector3d cut = a + (b - a) * a.z() / (a.z() - b.z());
        scan.points.push_back({frame, p, w,
                               Eigen::Vector2d(cut.x() / 0.08 + noise_px * random.normal(),
                                               cut.y() / 0.074 + noise_px * random.normal())});
      }
    }
  }
  return scan;
}

}  // namespace fathom
