#include "sim/studies/seen_target.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "core/random.h"
#include "registration/spatial_calibration.h"

namespace fathom {

namespace {

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

ProbePoses poses_of(const Recording& recording) { return probe_poses(recording, find_pose_chain(recording, {})); }

/// Pattern and number of a wire, by its name.
std::map<std::string, std::pair<std::size_t, std::size_t>> wires_by_name(const WirePhantom& phantom) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> wires;
  for (std::size_t p = 0; p < phantom.patterns.size(); ++p) {
    for (std::size_t w = 0; w < phantom.patterns[p].size(); ++w) wires[phantom.patterns[p][w].name] = {p, w};
  }
  return wires;
}

/// The line through both ends of a floor that a frame shows.
WallLine line_through(int frame, const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  WallLine line;
  line.frame = frame;
  line.point_px = 0.5 * (left + right);
  line.direction = (right - left).normalized();
  line.reach_px = (right - left).norm() / std::sqrt(12.0);  // of columns spread evenly between them
  return line;
}

SpatialState true_state(const Calibration& calibration) {
  const Eigen::Affine3d& probe_from_image = calibration.probe_from_image;
  SpatialState state = state_of(probe_from_image.linear().leftCols<2>(), probe_from_image.translation(), true);
  state.latency_s = calibration.latency_s;
  return state;
}

}  // namespace

WirePhantom three_n_phantom() {
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
  phantom.reference_from_phantom = Eigen::Translation3d(12, 34, -56) * Eigen::Isometry3d::Identity();
  return phantom;
}

TargetScanOptions target_scan_of(const std::string& object, int frames, std::uint64_t seed) {
  TargetScanOptions options;
  options.object = object;
  options.frames = frames;
  options.seed = seed;
  if (object == "wires") options.phantom = three_n_phantom();
  return options;
}

CalibrationPhantom calibration_phantom_of(const TargetScanOptions& options) {
  if (options.object != "wires") return calibration_phantom(options.object, {});
  return {CalibrationTarget::kWires, options.phantom};
}

double point_error_mm(const Calibration& truth, const Eigen::Affine3d& probe_from_image) {
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

SeenTarget::SeenTarget(const TargetScanOptions& options, const SimulatedTargetScan& scan, CalibrationScan seen)
    : phantom_(calibration_phantom_of(options)), truth_(scan.calibration), seen_(std::move(seen)) {
  seen_.poses = poses_of(*scan.recording);
}

SeenTarget SeenTarget::found_in_images(const TargetScanOptions& options, int step) {
  const SimulatedTargetScan scan = simulate_target(options);
  const ThinnedRecording some(*scan.recording, step);
  return {options, scan, scan_phantom(some, find_pose_chain(some, {}), calibration_phantom_of(options), {})};
}

SeenTarget SeenTarget::drawn(const TargetScanOptions& options, double noise_px, std::uint64_t seed) {
  const SimulatedTargetScan scan = simulate_target(options);
  const RecordingHeader& header = scan.recording->header();
  CalibrationScan seen(poses_of(*scan.recording), {header.width, header.height});
  const auto wires = wires_by_name(options.phantom);
  Random random(seed);
  std::map<int, Eigen::Vector2d> left;
  for (const TruePoint& point : scan.points) {
    const double x = random.normal();
    const Eigen::Vector2d at = point.position_px + noise_px * Eigen::Vector2d(x, random.normal());
    if (options.object == "point") seen.points.push_back({point.frame, at});
    if (options.object == "wires") {
      const auto& [pattern, wire] = wires.at(point.name);
      seen.wires.push_back({point.frame, pattern, wire, at});
    }
    if (point.name == "left") left[point.frame] = at;
    if (point.name == "right" && left.contains(point.frame)) {
      seen.lines.push_back(line_through(point.frame, left.at(point.frame), at));
    }
  }
  seen.frames_with_target = scan.frames_in_view;
  return {options, scan, std::move(seen)};
}

SpatialFit SeenTarget::fitted(double noise_mm, std::uint64_t tracker_seed, const ScanFitOptions& fitting) const {
  Random random(tracker_seed);
  auto poses = seen_.poses.poses();
  const double each_mm = noise_mm / std::sqrt(3.0);  // axis, of a distance in space
  const double each_rad = kTurnOfNoise_deg_per_mm * each_mm * std::numbers::pi / 180.0;
  for (auto& pose : poses) {
    if (pose) displace(*pose, each_mm, each_rad, random);
  }
  CalibrationScan tracked = seen_;
  tracked.poses = ProbePoses(seen_.poses.recording(), std::move(poses), seen_.poses.times_s());
  return calibrate_scan(tracked, phantom_, fitting);
}

CalibrationTrial SeenTarget::calibrated(double noise_mm, std::uint64_t tracker_seed,
                                        const ScanFitOptions& fitting) const {
  const SpatialFit fit = fitted(noise_mm, tracker_seed, fitting);
  const SpatialState truth = true_state(truth_);
  const Eigen::AngleAxisd turn(truth.rotation.conjugate() * fit.state.rotation);
  Eigen::VectorXd errors(kLatency + 1);
  errors << fit.state.translation_mm - truth.translation_mm, turn.angle() * turn.axis(),
      fit.state.log_sx - truth.log_sx, fit.state.log_sy - truth.log_sy, fit.state.skew - truth.skew,
      fit.state.latency_s - truth.latency_s;
  CalibrationTrial trial;
  trial.point_mm = point_error_mm(truth_, fit.state.probe_from_image());
  trial.stated_mm = fit.worst_point_sd_mm;
  trial.latency_s = errors[kLatency];
  std::vector<double> normalised;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (fit.parameters[i] > kLatency) continue;  // the phantom's place is not the calibration's
    normalised.push_back(errors[fit.parameters[i]] / std::sqrt(fit.covariance(at, at)));
  }
  trial.normalised = Eigen::Map<const Eigen::VectorXd>(normalised.data(), static_cast<Eigen::Index>(normalised.size()));
  return trial;
}

}  // namespace fathom
