#pragma once

#include <map>
#include <string>
#include <utility>

#include "registration/calibration_scan.h"
#include "sim/target_scan.h"

namespace fathom {

/// The phantom of PLUS's recordings: three Ns, 30 mm wide, 40 mm long and 20 mm high, that look different from behind.
inline WirePhantom three_ns() {
  WirePhantom phantom;
  phantom.name = "three Ns";
  const auto add = [&phantom](double z, double left, double right, double front, double back) {
    const std::string n = std::to_string(phantom.patterns.size());
    phantom.patterns.push_back({Wire{n + "a", {left, 0, z}, {left, 40, z}}, Wire{n + "b", {front, 0, z}, {back, 40, z}},
                                Wire{n + "c", {right, 0, z}, {right, 40, z}}});
  };
  add(20, 30, 60, 55, 35);
  add(10, 30, 60, 35, 55);
  add(0, 35, 60, 55, 40);
  return phantom;
}

inline TargetScanOptions target_options(const std::string& object, int frames, std::uint64_t seed,
                                        const std::string& probe = "linear") {
  TargetScanOptions options;
  options.object = object;
  options.probe = probe;
  options.frames = frames;
  options.seed = seed;
  if (object == "wires") {
    options.phantom = three_ns();
    options.phantom.reference_from_phantom = Eigen::Translation3d(12, 34, -56) * Eigen::Isometry3d::Identity();
  }
  return options;
}

/// What calibrates with such a scan.
inline CalibrationPhantom calibration_phantom_of(const TargetScanOptions& options) {
  if (options.object != "wires") return calibration_phantom(options.object, {});
  return {CalibrationTarget::kWires, options.phantom};
}

/// Every `step`th image of a scan: the others are marked invalid, and need not be made.
class ThinnedRecording : public Recording {
 public:
  ThinnedRecording(const Recording& recording, int step)
      : Recording(recording.name(), recording.header()), all_(recording) {
    for (int frame = 0; frame < header_.frame_count(); ++frame) {
      if (frame % step != 0) header_.frames[static_cast<std::size_t>(frame)].image_status = "INVALID";
    }
  }
  cv::Mat image(int frame) const override { return all_.image(frame); }

 private:
  const Recording& all_;
};

/// True places by frame and name.
using TruePlaces = std::map<std::pair<int, std::string>, Eigen::Vector2d>;
inline TruePlaces places_of(const SimulatedTargetScan& scan) {
  TruePlaces places;
  for (const TruePoint& point : scan.points) places[{point.frame, point.name}] = point.position_px;
  return places;
}

/// rms distance between where two calibrations put the places of a grid over the image.
inline double point_error_mm(const Calibration& truth, const Eigen::Affine3d& probe_from_image) {
  constexpr int kSteps = 8;
  double squares = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector3d pixel(truth.image_size->width * i / static_cast<double>(kSteps),
                                  truth.image_size->height * k / static_cast<double>(kSteps), 0.0);
      squares += (probe_from_image * pixel - truth.probe_from_image * pixel).squaredNorm();
    }
  }
  return std::sqrt(squares / ((kSteps + 1) * (kSteps + 1)));
}

}  // namespace fathom
