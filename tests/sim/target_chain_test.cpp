#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/registration/poses.h"
#include "tests/sim/target_scans.h"

namespace fathom {
namespace {

constexpr int kFrames = 250;  // ten seconds

/// What is seen of a target in images, with any tracker: images do not depend on it.
class SeenTarget {
 public:
  SeenTarget(TargetScanOptions options, int step)
      : options_(std::move(options)), phantom_(calibration_phantom_of(options_)) {
    const SimulatedTargetScan scan = simulate_target(options_);
    const ThinnedRecording some(*scan.recording, step);
    seen_.emplace(scan_phantom(some, find_pose_chain(some, {}), phantom_, {}));
  }

  int frames_seen() const { return seen_->frames_with_target; }

  struct Calibrated {
    SpatialFit fit;
    Calibration truth;
    double off_mm = 0.0;  ///< rms over the image
    double late_s = 0.0;  ///< error of the latency
  };

  /// With a tracker of so much noise (rms distance; 0.6 degrees for each mm), another one for each `seed`.
  Calibrated calibrated(double noise_mm, double latency_s, std::uint64_t seed, const ScanFitOptions& fitting) const {
    TargetScanOptions options = options_;
    options.latency_s = latency_s;
    const SimulatedTargetScan scan = simulate_target(options);
    const ProbePoses exact = probe_poses(*scan.recording, find_pose_chain(*scan.recording, {}));
    Random random(seed);
    auto poses = exact.poses();
    const double mm = noise_mm / std::sqrt(3.0);
    for (auto& pose : poses) pose = trembling(*pose, mm, 0.6 * mm * std::numbers::pi / 180.0, random);
    CalibrationScan tracked = *seen_;
    tracked.poses = ProbePoses(exact.recording(), std::move(poses), exact.times_s());
    Calibrated result{calibrate_scan(tracked, phantom_, fitting), scan.calibration};
    const Calibration found = calibration_of(result.fit);
    result.off_mm = point_error_mm(scan.calibration, found.probe_from_image);
    result.late_s = found.latency_s - scan.calibration.latency_s;
    return result;
  }

 private:
  TargetScanOptions options_;
  CalibrationPhantom phantom_;
  std::optional<CalibrationScan> seen_;
};

ScanFitOptions fitting(bool registered, bool latency) {
  ScanFitOptions options;
  options.try_skew = false;
  options.try_latency = latency;
  options.estimate_phantom = !registered;
  return options;
}

TEST(TargetChain, FromImagesOfWiresToPointsInSpace) {
  const SeenTarget seen(target_options("wires", kFrames, 4), 10);
  EXPECT_EQ(seen.frames_seen(), 25);
  EXPECT_LT(seen.calibrated(0.25, 0.0, 1, fitting(true, false)).off_mm, 0.4);
}

TEST(TargetChainStudy, PointsInSpaceAndLatencyFromImages) {
  constexpr int kScans = 2;
  constexpr int kTrackers = 4;
  std::printf(
      "target | tracker's noise (mm) | calibrations | point error, rms; worst (mm) | largest stated sd of a pixel (mm) "
      "| latency error, worst (ms)\n");
  std::map<std::string, double> unregistered_mm;
  for (const std::string target : {"wires", "wires unregistered", "wall", "point"}) {
    const bool registered = target != "wires unregistered";
    std::vector<SeenTarget> seen;
    for (std::uint64_t scan = 0; scan < kScans; ++scan) {
      seen.emplace_back(target_options(registered ? target : "wires", kFrames, 40 + scan), 4);
    }
    for (const double noise_mm : {0.0, 0.25, 0.5}) {
      double squares = 0.0;
      double worst = 0.0;
      double stated = 0.0;
      double late = 0.0;
      int count = 0;
      for (int run = 0; run < (noise_mm > 0.0 ? kTrackers : 2); ++run) {
        for (const SeenTarget& scan : seen) {
          const auto one = scan.calibrated(noise_mm, -0.3 + 0.6 * run / kTrackers, 1 + static_cast<std::uint64_t>(run),
                                           fitting(registered, true));
          squares += one.off_mm * one.off_mm;
          worst = std::max(worst, one.off_mm);
          stated = std::max(stated, one.fit.worst_point_sd_mm);
          late = std::max(late, std::abs(one.late_s));
          ++count;
        }
      }
      const double rms = std::sqrt(squares / count);
      std::printf("%s | %.2f | %d | %.3f; %.3f | %.3f | %.2f\n", target.c_str(), noise_mm, count, rms, worst, stated,
                  1e3 * late);
      if (noise_mm == 0.25) {
        EXPECT_LE(rms, 0.4) << target;
        EXPECT_LE(late, 0.005) << target;
        unregistered_mm[target] = rms;
      }
    }
  }
  EXPECT_LE(unregistered_mm["wall"], 2.0 * unregistered_mm["wires unregistered"]);
}

}  // namespace
}  // namespace fathom
