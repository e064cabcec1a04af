#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/random.h"
#include "registration/temporal_motion.h"
#include "tests/registration/coverage.h"
#include "tests/sim/target_scans.h"

namespace fathom {
namespace {

TargetScanOptions up_and_down(int frames, double latency_s, std::uint64_t seed, double noise_mm) {
  TargetScanOptions options = target_scan_of("wall", frames, seed);
  options.pattern = "floor";
  options.latency_s = latency_s;
  options.noise_mm = noise_mm;
  options.noise_deg = 0.6 * noise_mm;
  return options;
}

/// The floor's true depth in the middle column, and noise.
Signal true_depth(const SimulatedTargetScan& scan, double noise_px, Random& random) {
  const TruePlaces places = places_of(scan);
  Signal depth{"floor", {}};
  const RecordingHeader& header = scan.recording->header();
  for (int frame = 0; frame < header.frame_count(); ++frame) {
    const auto left = places.find({frame, "left"});
    if (left == places.end()) continue;
    const double y = 0.5 * (left->second.y() + places.at({frame, "right"}).y());
    depth.values.push_back({*header.frames[static_cast<std::size_t>(frame)].time_s, y + noise_px * random.normal()});
  }
  return depth;
}

ProbePoses tracked(const Recording& recording) { return probe_poses(recording, find_pose_chain(recording, {})); }

TEST(TargetLatency, IsFoundThoughTheHandAlsoTilts) {
  Random random(9);
  for (const double latency_s : {-0.283, 0.117}) {
    const SimulatedTargetScan scan = simulate_target(up_and_down(300, latency_s, 3, 0.0));
    const TemporalCalibration fit = find_latency(true_depth(scan, 0.5, random), tracked(*scan.recording));
    EXPECT_NEAR(fit.latency_s, latency_s, 0.002);
    EXPECT_NEAR(fit.latency_s, latency_s, 4.0 * fit.stddev_s);
    EXPECT_GT(fit.correlation, 0.999);
  }
}

TEST(TargetLatencyStudy, FromImages) {
  for (const double latency_s : {-0.283, 0.391}) {
    const SimulatedTargetScan scan = simulate_target(up_and_down(300, latency_s, 3, 0.25));
    const TemporalCalibration fit =
        find_latency(floor_signal(*scan.recording, detect_wall(*scan.recording)), tracked(*scan.recording));
    std::printf("%.0f ms: %.2f ms off, stated %.2f, correlation %.5f\n", 1e3 * latency_s,
                1e3 * (fit.latency_s - latency_s), 1e3 * fit.stddev_s, fit.correlation);
    EXPECT_NEAR(fit.latency_s, latency_s, 0.002);
  }
}

TEST(TargetLatencyStudy, OverHalfASecondEitherWay) {
  std::printf("tracker's noise (mm) | worst error (ms) | rms (ms) | stated (ms) | spread | within 1.96\n");
  for (const double noise_mm : {0.0, 0.25}) {
    Random random(5);
    Coverage coverage;
    double worst = 0.0;
    double squares = 0.0;
    double stated = 0.0;
    int runs = 0;
    for (int ms = -480; ms <= 480; ms += 32, ++runs) {
      const SimulatedTargetScan scan =
          simulate_target(up_and_down(500, 0.001 * ms, 100 + static_cast<std::uint64_t>(runs), noise_mm));
      const TemporalCalibration fit = find_latency(true_depth(scan, 0.5, random), tracked(*scan.recording));
      const double error = fit.latency_s - 0.001 * ms;
      worst = std::max(worst, std::abs(error));
      squares += error * error;
      stated += fit.stddev_s * fit.stddev_s;
      coverage.add(Eigen::VectorXd::Constant(1, error), Eigen::VectorXd::Constant(1, fit.stddev_s));
    }
    std::printf("%.2f | %.2f | %.2f | %.2f | %.2f | %.3f\n", noise_mm, 1e3 * worst, 1e3 * std::sqrt(squares / runs),
                1e3 * std::sqrt(stated / runs), coverage.spread(), coverage.share());
    EXPECT_LE(worst, 0.002);
  }
}

}  // namespace
}  // namespace fathom
