#include "sim/probe_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/random_stream.h"

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
constexpr double kPause_s = 2.0;  // between sweeps, while the probe is moved to the next window
constexpr double kSensorDistance_mm = 100.0;
constexpr double kLoneFrameStep = 0.05;  // of the path, per frame, where a single frame gives no step

/// A disturbance of each frame, uniform in +- on three axes and three angles.
std::vector<ScanPlane> uniform_planes(Random random, int count, double mm, double deg) {
  std::vector<ScanPlane> planes(static_cast<std::size_t>(count));
  for (ScanPlane& plane : planes) {
    for (int axis = 0; axis < 3; ++axis) plane.position_mm[axis] = random.uniform(-1.0, 1.0) * mm;
    plane.azimuth_rad = random.uniform(-1.0, 1.0) * deg * kRadian;
    plane.elevation_rad = random.uniform(-1.0, 1.0) * deg * kRadian;
    plane.roll_rad = random.uniform(-1.0, 1.0) * deg * kRadian;
  }
  return planes;
}

/// The disturbance at a time between a sweep's frames, `at` counted in frames.
ScanPlane between(const std::vector<ScanPlane>& planes, const Sweep& sweep, double at) {
  const double bounded = std::clamp(at, static_cast<double>(sweep.first), static_cast<double>(sweep.last));
  const double before = std::floor(bounded);
  const auto i = static_cast<std::size_t>(before);
  if (bounded == before) return planes[i];
  return planes[i] * (1.0 - (bounded - before)) + planes[i + 1] * (bounded - before);
}

}  // namespace

Calibration simulated_calibration(const Eigen::Vector2d& pixel_mm, cv::Size image_size, double latency_s) {
  const Eigen::Matrix3d turn = placed({0.31, -1.12, 0.64}, Eigen::Vector3d::Zero()).linear();
  const Eigen::Vector3d scale(pixel_mm.x(), pixel_mm.y(), pixel_mm.mean());
  const Eigen::Vector3d centre_px((image_size.width - 1) / 2.0, (image_size.height - 1) / 2.0, 0.0);
  const Eigen::Vector3d centre_mm = kSensorDistance_mm * Eigen::Vector3d(0.28, -0.36, 0.89).normalized();

  Calibration calibration;
  calibration.probe_from_image.linear() = turn * scale.asDiagonal();
  calibration.probe_from_image.translation() = centre_mm - calibration.probe_from_image.linear() * centre_px;
  calibration.latency_s = latency_s;
  calibration.probe_frame = "Probe";
  calibration.reference_frame = "Reference";
  calibration.image_size = image_size;
  calibration.depth_mm = image_size.height * pixel_mm.y();
  calibration.probe = "simulated";
  return calibration;
}

ProbeMotion move_probe(const ScanPlan& plan, const Phantom& phantom, const Calibration& calibration,
                       const SimulateOptions& options) {
  std::vector<ScanPlane> jitter = uniform_planes(random_stream(options.seed, Stream::kJitter), options.frames,
                                                 options.jitter_mm, options.jitter_deg);
  const std::vector<ScanPlane> misregistration =
      uniform_planes(random_stream(options.seed, Stream::kMisregistration), options.frames, options.misregister_mm,
                     options.misregister_deg);

  ProbeMotion motion;
  for (const int share : frames_of_sweeps(options.frames, plan.sweeps.size())) {
    const int first = motion.sweeps.empty() ? 0 : motion.sweeps.back().last + 1;
    motion.sweeps.push_back({0, first, first + share - 1});
    if (!options.steady_ends) continue;
    for (const int end : {motion.sweeps.back().first, motion.sweeps.back().last}) {
      jitter[static_cast<std::size_t>(end)] = {};
    }
  }
  const Eigen::Isometry3d tracker_from_phantom =
      simulated_tracker_from_reference() * simulated_reference_from_phantom();
  const Eigen::Affine3d image_from_probe = calibration.probe_from_image.inverse();

  std::vector<double> times_s;
  std::vector<Eigen::Isometry3d> tracker_from_probe;
  std::size_t number = 0;  // of the sweep
  for (int frame = 0; frame < options.frames; ++frame) {
    if (frame > motion.sweeps[number].last) ++number;
    const Sweep& sweep = motion.sweeps[number];
    const ScanPath& path = plan.sweeps[number];
    const auto plane_at = [&](double at) {
      const double in_sweep = at - sweep.first;
      const int count = frame_count(sweep);
      return path.at(count > 1 ? in_sweep / (count - 1) : 0.5 + in_sweep * kLoneFrameStep) + between(jitter, sweep, at);
    };
    times_s.push_back(kFirstTime_s + frame / kFrameRate_hz + static_cast<double>(number) * kPause_s);
    motion.phantom_from_image.push_back(path.phantom_from_image(plane_at(frame), phantom.pixel_mm));

    const ScanPlane seen =
        options.latency_s == 0.0 ? plane_at(frame) : plane_at(frame - options.latency_s * kFrameRate_hz);
    const ScanPlane recorded = seen + misregistration[static_cast<std::size_t>(frame)];
    tracker_from_probe.emplace_back(
        (tracker_from_phantom.matrix() * path.phantom_from_image(recorded, phantom.pixel_mm).matrix() *
         image_from_probe.matrix())
            .eval());
  }
  motion.tracked = track(std::move(times_s), std::move(tracker_from_probe), options);
  return motion;
}

}  // namespace fathom
