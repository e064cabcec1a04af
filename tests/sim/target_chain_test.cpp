#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "sim/studies/seen_target.h"

namespace fathom {
namespace {

constexpr int kFrames = 250;  // ten seconds
constexpr double kNoise_mm = 0.25;

ScanFitOptions fitting(bool registered, bool latency) {
  ScanFitOptions options;
  options.try_skew = false;
  options.try_latency = latency;
  options.estimate_phantom = !registered;
  return options;
}

TEST(TargetChain, FromImagesOfWiresToPointsInSpace) {
  const SeenTarget seen = SeenTarget::found_in_images(target_scan_of("wires", kFrames, 4), 10);
  EXPECT_EQ(seen.frames_seen(), 25);
  EXPECT_LT(seen.calibrated(kNoise_mm, 1, fitting(true, false)).point_mm, 0.4);
}

TEST(TargetChain, WithoutNoiseFindsTheTruthToTheInterpolationOfPoses) {
  for (const std::string target : {"wires", "wall"}) {
    const SeenTarget seen = SeenTarget::drawn(target_scan_of(target, kFrames, 5), 0.0, 1);
    const CalibrationTrial trial = seen.calibrated(0.0, 1, fitting(true, false));
    EXPECT_LT(trial.point_mm, 1e-4) << target;
  }
}

TEST(TargetChain, ErrorsGrowInProportionToTheTrackersNoise) {
  const SeenTarget seen = SeenTarget::drawn(target_scan_of("wires", kFrames, 6), 0.0, 1);
  const double little = seen.calibrated(0.1, 3, fitting(true, false)).point_mm;
  EXPECT_NEAR(seen.calibrated(0.3, 3, fitting(true, false)).point_mm, 3.0 * little, 0.3 * little);
}

TEST(TargetChainStudy, PointsInSpaceAndLatencyFromImages) {
  constexpr std::uint64_t kTrackers = 4;
  std::map<std::string, double> rms_mm;
  for (const std::string target : {"wires", "wires unregistered", "wall", "point"}) {
    const bool registered = target != "wires unregistered";
    double squares = 0.0;
    double late_s = 0.0;
    int count = 0;
    for (const double latency_s : {-0.3, 0.15}) {
      TargetScanOptions options = target_scan_of(registered ? target : "wires", kFrames, 40);
      options.latency_s = latency_s;
      const SeenTarget seen = SeenTarget::found_in_images(options, 4);
      for (std::uint64_t tracker = 1; tracker <= kTrackers; ++tracker, ++count) {
        const CalibrationTrial trial = seen.calibrated(kNoise_mm, tracker, fitting(registered, true));
        squares += trial.point_mm * trial.point_mm;
        late_s = std::max(late_s, std::abs(trial.latency_s));
      }
    }
    rms_mm[target] = std::sqrt(squares / count);
    std::printf("%s: %.3f mm, latency %.2f ms\n", target.c_str(), rms_mm[target], 1e3 * late_s);
    EXPECT_LE(rms_mm[target], 0.4) << target;
    EXPECT_LE(late_s, 0.005) << target;
  }
  EXPECT_LE(rms_mm["wall"], 2.0 * rms_mm["wires unregistered"]);
}

}  // namespace
}  // namespace fathom
