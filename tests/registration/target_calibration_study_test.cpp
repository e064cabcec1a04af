#include <cmath>
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>

#include "core/error.h"
#include "registration/point_calibration.h"
#include "registration/wall_calibration.h"
#include "registration/wire_calibration.h"
#include "tests/registration/coverage.h"
#include "tests/registration/target_scans.h"
#include "tests/registration/wire_scans.h"

namespace fathom {
namespace {

enum class Phantom { kWires, kWall, kPoint };
constexpr std::array kPhantoms = {Phantom::kWires, Phantom::kWall, Phantom::kPoint};
constexpr std::array kNames = {"wires", "wall", "point"};

struct Trial {
  SpatialState truth;
  SpatialFit fit;
};

constexpr double kTrackerMm = 0.25 / 1.7321;  // on each axis: 0.25 mm in space
constexpr double kTrackerRad = 0.15 / 57.2958 / 1.7321;

SpatialOptions options_for(Phantom phantom, bool latency) {
  SpatialOptions options;
  if (phantom == Phantom::kWall) options = wall_options();
  if (phantom == Phantom::kPoint) options = point_options();
  options.try_latency = latency;
  options.try_skew = false;
  return options;
}

/// One scan and its calibration; `wrong` of the frames have a pose far off.
Trial made(Phantom phantom, double noise_px, bool tracker, double wrong, double latency_s, bool fit_latency,
           Random& random) {
  const auto spoil = [&](std::vector<std::optional<Eigen::Isometry3d>>& poses) {
    for (auto& pose : poses) {
      if (random.uniform() >= wrong) continue;
      pose->translation() += 15.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    }
  };
  const double mm = tracker ? kTrackerMm : 0.0;
  const double rad = tracker ? kTrackerRad : 0.0;
  const SpatialOptions options = options_for(phantom, fit_latency);
  if (phantom == Phantom::kWires) {
    constexpr double kLatePace = 3.0;  // a latency shows in motion: 50 mm/s, as over the other phantoms
    WireScan scan = scan_wires(random, noise_px, latency_s, mm, rad, fit_latency ? kLatePace : 1.0);
    spoil(scan.poses);
    WireCalibrationOptions wires;
    wires.spatial = options;
    return {scan.truth, calibrate_with_wires(scan.tracked(), scan.points, scan.phantom, wires)};
  }
  TargetScanning how;
  how.noise_px = noise_px;
  how.tracker_mm = mm;
  how.tracker_rad = rad;
  how.latency_s = latency_s;
  const bool wall = phantom == Phantom::kWall;
  TargetScan scan = scan_target(how, wall, random);
  spoil(scan.poses);
  return {scan.truth, wall ? calibrate_with_wall(scan.tracked(), scan.lines, options)
                           : calibrate_with_point(scan.tracked(), scan.points, options)};
}

/// Errors of the calibration's own parameters, in the order of the fit's.
Eigen::VectorXd parameter_errors(const Trial& run, Eigen::VectorXd& sd) {
  const Eigen::AngleAxisd turn(run.truth.rotation.conjugate() * run.fit.state.rotation);
  Eigen::VectorXd all(kLatency + 1);
  all << run.fit.state.translation_mm - run.truth.translation_mm, turn.angle() * turn.axis(),
      run.fit.state.log_sx - run.truth.log_sx, run.fit.state.log_sy - run.truth.log_sy,
      run.fit.state.skew - run.truth.skew, run.fit.state.latency_s - run.truth.latency_s;
  std::vector<double> errors;
  std::vector<double> deviations;
  for (std::size_t i = 0; i < run.fit.parameters.size(); ++i) {
    const int parameter = run.fit.parameters[i];
    if (parameter > kLatency) continue;
    const auto at = static_cast<Eigen::Index>(i);
    errors.push_back(all[parameter]);
    deviations.push_back(std::sqrt(run.fit.covariance(at, at)));
  }
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  sd = vector(deviations);
  return vector(errors);
}

/// Squared error of the middle of the image, mm2.
double squared_point_error(const Trial& run) {
  const Eigen::Vector3d middle(kScanWidth_px / 2.0, kScanHeight_px / 2.0, 0.0);
  return (run.fit.state.probe_from_image() * middle - run.truth.probe_from_image() * middle).squaredNorm();
}

TEST(TargetCalibrationStudy, ErrorsAreAsLargeAsTheCovarianceSays) {
  std::printf(
      "phantom | noise (px) | tracker's noise | runs | failed | rms error of the image's middle (mm) | spread | within "
      "1.96\n");
  for (std::size_t p = 0; p < kPhantoms.size(); ++p) {
    Coverage all;
    for (const auto& [noise_px, tracker] : {std::pair{0.5, false}, {1.0, false}, {3.0, false}, {1.0, true}}) {
      Random random(50 + p);
      Coverage coverage;
      double squares = 0.0;
      int failed = 0;
      constexpr int kRuns = 500;
      for (int run = 0; run < kRuns; ++run) {
        try {
          const Trial one = made(kPhantoms[p], noise_px, tracker, 0.0, 0.0, false, random);
          Eigen::VectorXd sd;
          const Eigen::VectorXd errors = parameter_errors(one, sd);
          coverage.add(errors, sd);
          all.add(errors, sd);
          squares += squared_point_error(one);
        } catch (const Error&) {
          ++failed;
        }
      }
      std::printf("%s | %.1f | %s | %d | %d | %.3f | %.3f | %.3f\n", kNames[p], noise_px,
                  tracker ? "0.25 mm, 0.15 deg" : "0", kRuns, failed, std::sqrt(squares / (kRuns - failed)),
                  coverage.spread(), coverage.share());
      EXPECT_EQ(failed, 0);
    }
    std::printf("%s, all | | | 2000 | | | %.3f | %.3f\n", kNames[p], all.spread(), all.share());
    expect_covered(all);
  }
}

TEST(TargetCalibrationStudy, AFifthOfTheFramesWrongChangesLittle) {
  std::printf("phantom | rms change by 20 %% wrong frames, in standard deviations | worst\n");
  for (std::size_t p = 0; p < kPhantoms.size(); ++p) {
    double squares = 0.0;
    double worst = 0.0;
    int count = 0;
    for (int run = 0; run < 100; ++run) {
      Random clean_numbers(1000 + static_cast<std::uint64_t>(run));
      const Trial clean = made(kPhantoms[p], 1.0, true, 0.0, 0.0, false, clean_numbers);
      Random same_numbers(1000 + static_cast<std::uint64_t>(run));
      const Trial spoilt = made(kPhantoms[p], 1.0, true, 0.2, 0.0, false, same_numbers);
      Eigen::VectorXd sd;
      const Eigen::VectorXd change = parameter_errors(spoilt, sd) - parameter_errors(clean, sd);
      squares += change.cwiseQuotient(sd).squaredNorm();
      worst = std::max(worst, change.cwiseQuotient(sd).cwiseAbs().maxCoeff());
      count += static_cast<int>(change.size());
    }
    std::printf("%s | %.2f | %.2f\n", kNames[p], std::sqrt(squares / count), worst);
    EXPECT_LE(std::sqrt(squares / count), 1.0);
  }
}

TEST(TargetCalibrationStudy, LatencyTogetherWithTheCalibration) {
  std::printf("phantom | runs | worst error of the latency (ms) | rms (ms)\n");
  for (std::size_t p = 0; p < kPhantoms.size(); ++p) {
    Random random(70 + p);
    double worst = 0.0;
    double squares = 0.0;
    constexpr int kRuns = 60;
    for (int run = 0; run < kRuns; ++run) {
      const double latency_s = random.uniform(-0.3, 0.3);
      const Trial one = made(kPhantoms[p], 1.0, true, 0.0, latency_s, true, random);
      const double error = one.fit.state.latency_s - latency_s;
      worst = std::max(worst, std::abs(error));
      squares += error * error / kRuns;
    }
    std::printf("%s | %d | %.2f | %.2f\n", kNames[p], kRuns, 1e3 * worst, 1e3 * std::sqrt(squares));
    EXPECT_LE(worst, 0.005);
  }
}

/// rms error of the image's middle over many scans, mm.
double point_error_mm(const std::function<Trial(Random&)>& trial) {
  Random random(80);
  double squares = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) squares += squared_point_error(trial(random)) / kRuns;
  return std::sqrt(squares);
}

TEST(TargetCalibrationStudy, PointErrorsOfTheThreePhantoms) {
  const auto wires = [](bool registered) {
    return point_error_mm([registered](Random& random) {
      WireScan scan = scan_wires(random, 1.0, 0.0, kTrackerMm, kTrackerRad);
      if (!registered) scan.phantom.reference_from_phantom.reset();
      WireCalibrationOptions options;
      options.spatial = options_for(Phantom::kWires, false);
      return Trial{scan.truth, calibrate_with_wires(scan.tracked(), scan.points, scan.phantom, options)};
    });
  };
  const auto wall = [](int frames, double tilt_rad) {
    return point_error_mm([=](Random& random) {
      TargetScanning how;
      how.tracker_mm = kTrackerMm;
      how.tracker_rad = kTrackerRad;
      how.frames = frames;
      how.tilt_rad = tilt_rad;
      const TargetScan scan = scan_target(how, true, random);
      return Trial{scan.truth, calibrate_with_wall(scan.tracked(), scan.lines, options_for(Phantom::kWall, false))};
    });
  };
  const double registered = wires(true);
  const double unregistered = wires(false);
  const double careful = wall(120, 0.7);
  std::printf("rms error of the image's middle, mm\n");
  std::printf("wires, registered without error, 120 frames | %.3f\n", registered);
  std::printf("wires, place estimated, 120 frames | %.3f\n", unregistered);
  std::printf("floor, 120 frames, tilted by up to 26 degrees | %.3f\n", wall(120, 0.45));
  std::printf("floor, 120 frames, tilted by up to 40 degrees | %.3f\n", careful);
  std::printf("floor, 600 frames, tilted by up to 40 degrees | %.3f\n", wall(600, 0.7));
  // With as many frames; without a registration both have to find where the phantom is.
  EXPECT_LE(careful, 2.0 * unregistered);
}

}  // namespace
}  // namespace fathom
