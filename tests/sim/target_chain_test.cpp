#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/registration/coverage.h"
#include "tests/sim/target_scans.h"

namespace fathom {
namespace {

/// A calibration from images alone.
struct Chain {
  SpatialFit fit;
  double off_mm = 0.0;     ///< rms over the image
  double latency_s = 0.0;  ///< error of it
  int frames_found = 0;
};

Chain calibrated(const TargetScanOptions& options, bool registered, bool try_latency) {
  const SimulatedTargetScan scan = simulate_target(options);
  const CalibrationPhantom phantom = calibration_phantom_of(options);
  CalibrationScan seen = scan_phantom(*scan.recording, find_pose_chain(*scan.recording, {}), phantom, {});
  ScanFitOptions fitting;
  fitting.try_latency = try_latency;
  fitting.try_skew = false;
  fitting.estimate_phantom = !registered;
  Chain chain;
  chain.fit = calibrate_scan(seen, phantom, fitting);
  const Calibration found = calibration_of(chain.fit);
  chain.off_mm = point_error_mm(scan.calibration, found.probe_from_image);
  chain.latency_s = found.latency_s - scan.calibration.latency_s;
  chain.frames_found = seen.frames_with_target;
  return chain;
}

TargetScanOptions noisy(TargetScanOptions options, double noise_mm = 0.25) {
  options.noise_mm = noise_mm;
  options.noise_deg = 0.6 * noise_mm;
  return options;
}

class TargetChain : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Targets, TargetChain, testing::Values("wires", "wall", "point"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(TargetChain, FromImagesToPointsInSpace) {
  const Chain chain = calibrated(noisy(target_options(GetParam(), 30, 4), 0.1), true, false);
  EXPECT_GE(chain.frames_found, 29);
  EXPECT_LT(chain.off_mm, 0.4);
}

using TargetChainStudy = TargetChain;
INSTANTIATE_TEST_SUITE_P(Targets, TargetChainStudy, testing::Values("wires", "wall", "point"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(TargetChainStudy, PointsInSpaceAndLatency) {
  constexpr int kRuns = 6;
  std::printf(
      "target | tracker's noise (mm) | runs | point error, rms, worst (mm) | worst sd stated (mm) | latency error, "
      "worst (ms)\n");
  for (const double noise_mm : {0.0, 0.25, 0.5}) {
    double squares = 0.0;
    double worst = 0.0;
    double stated = 0.0;
    double late = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      TargetScanOptions options =
          noisy(target_options(GetParam(), 120, 40 + static_cast<std::uint64_t>(run)), noise_mm);
      options.latency_s = -0.3 + 0.1 * run;
      const Chain chain = calibrated(options, true, true);
      squares += chain.off_mm * chain.off_mm / kRuns;
      worst = std::max(worst, chain.off_mm);
      stated = std::max(stated, chain.fit.worst_point_sd_mm);
      late = std::max(late, std::abs(chain.latency_s));
    }
    std::printf("%s | %.2f | %d | %.3f | %.3f | %.3f | %.2f\n", GetParam(), noise_mm, kRuns, std::sqrt(squares), worst,
                stated, 1e3 * late);
    if (noise_mm <= 0.25) {
      EXPECT_LE(std::sqrt(squares), 0.4);
      EXPECT_LE(late, 0.005);
    }
  }
}

}  // namespace
}  // namespace fathom
