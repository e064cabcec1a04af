#include "registration/spatial_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/numbers.h"
#include "registration/spatial_calibration_covariance.h"
#include "registration/spatial_calibration_errors.h"
#include "registration/spatial_calibration_solve.h"

namespace fathom {

namespace {

constexpr double kCauchyScale = 2.4;  // 95 % as efficient as plain squares under Gaussian errors
constexpr int kRounds = 8;
constexpr int kBlocks = 10;                  // of frames that follow each other, left out in turn
constexpr double kBetterBeyondChance = 2.0;  // standard errors of the paired difference
constexpr double kBetterAtAll = 0.01;        // of the mean squared distance: less is not worth a parameter

std::vector<int> parameters_of(const SpatialMask& fitted) {
  std::vector<int> parameters;
  for (int i = 0; i < kSpatialParameters; ++i) {
    if (fitted[static_cast<std::size_t>(i)]) parameters.push_back(i);
  }
  return parameters;
}

SpatialFit robust_fit(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                      const SpatialState& start, const SpatialMask& fitted, const SpatialOptions& options) {
  SpatialFit fit;
  fit.state = start;
  fit.fitted = fitted;
  fit.parameters = parameters_of(fitted);
  constexpr int kLossRounds = 3;
  for (int round = 0; round < kLossRounds; ++round) {
    const SpatialErrors errors = spatial_errors(poses, observations, fit.state);
    fit.used = errors.inside;
    const double scale = kCauchyScale * row_scale(observations, errors, fit.used);
    fit.state = solve_spatial(poses, observations, fit.used, fit.state, fitted, scale, 20, options.max_latency_s);
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<bool> before = fit.used;
    fit.used = without_outliers(observations, spatial_errors(poses, observations, fit.state));
    if (round > 0 && fit.used == before) break;
    fit.state = solve_spatial(poses, observations, fit.used, fit.state, fitted, 0.0, 30, options.max_latency_s);
  }
  fit.frames_used = static_cast<int>(frames_of(observations, fit.used).size());
  fit.frames_seen = static_cast<int>(frames_of(observations, std::vector<bool>(observations.size(), true)).size());
  return fit;
}

// The rms of the smaller distances over the pixel's size: in pixels, or shrinking the image to a point would win.
double badness(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
               const SpatialState& state) {
  constexpr double kShare = 0.7;  // a fifth of the frames may be wrong
  const SpatialErrors errors = spatial_errors(poses, observations, state);
  std::vector<double> squares;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (errors.inside[i]) squares.push_back(errors.error_mm[i].squaredNorm());
  }
  if (squares.empty()) return std::numeric_limits<double>::infinity();
  const auto end = squares.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(squares.size() - 1)) + 1;
  std::nth_element(squares.begin(), end - 1, squares.end());
  const double mean = std::accumulate(squares.begin(), end, 0.0) / static_cast<double>(end - squares.begin());
  return std::sqrt(mean) / std::exp(0.5 * (state.log_sx + state.log_sy));
}

bool plausible(const SpatialState& state) {
  constexpr double kMinPixelMm = 0.002;  // as for calibrations that are read
  constexpr double kMaxPixelMm = 5.0;
  constexpr double kMaxAspect = 4.0;  // of a pixel: scanners show square ones, sampled by cards at most twice as wide
  const double sx = std::exp(state.log_sx);
  const double sy = std::exp(state.log_sy);
  return sx > kMinPixelMm && sx < kMaxPixelMm && sy > kMinPixelMm && sy < kMaxPixelMm &&
         std::max(sx / sy, sy / sx) < kMaxAspect && std::abs(state.skew) < 0.5;
}

SpatialMask base_mask(const SpatialOptions& options) {
  SpatialMask mask = options.phantom;
  for (int i = kTx; i <= kLogSy; ++i) mask[static_cast<std::size_t>(i)] = true;
  return mask;
}

bool better_beyond_chance(const std::vector<std::pair<int, double>>& simple,
                          const std::vector<std::pair<int, double>>& richer) {
  std::vector<double> gains;
  double total = 0.0;
  for (std::size_t i = 0; i < simple.size(); ++i) {
    gains.push_back(simple[i].second - richer[i].second);
    total += simple[i].second;
  }
  const auto n = static_cast<double>(gains.size());
  const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / n;
  double squares = 0.0;
  for (const double gain : gains) squares += (gain - mean) * (gain - mean);
  const double standard_error = std::sqrt(squares / (n * std::max(1.0, n - 1.0)));
  return mean > kBetterBeyondChance * standard_error && mean > kBetterAtAll * total / n;
}

void keep_better(std::optional<SpatialFit>& best, const ProbePoses& poses,
                 const std::vector<SpatialObservation>& observations, const SpatialState& start,
                 const SpatialMask& fitted, const SpatialOptions& options) {
  SpatialFit fit = robust_fit(poses, observations, start, fitted, options);
  if (!plausible(fit.state) || fit.frames_used < options.min_frames) return;
  if (!best || badness(poses, observations, fit.state) < badness(poses, observations, best->state)) {
    best = std::move(fit);
  }
}

// Both are judged on the frames that the richer fit uses and the simple one knows the pose of.
bool predicts_better(const ProbePoses& poses, const std::vector<SpatialObservation>& observations, SpatialFit simple,
                     SpatialFit richer) {
  const SpatialErrors errors = spatial_errors(poses, observations, simple.state);
  for (std::size_t i = 0; i < richer.used.size(); ++i) richer.used[i] = richer.used[i] && errors.inside[i];
  simple.used = richer.used;
  return better_beyond_chance(cross_validated(poses, observations, simple),
                              cross_validated(poses, observations, richer));
}

std::string nothing_fits(const ProbePoses& poses, const SpatialOptions& options) {
  return poses.recording() + ": no calibration fits what was seen (fewer than " + std::to_string(options.min_frames) +
         " frames agree); " +
         (options.target == CalibrationTarget::kWires
              ? "check that the phantom's file is that of the phantom scanned, and record again"
              : "check that nothing else is as bright in the images as " + name_of(options.target) +
                    ", and record again");
}

}  // namespace

std::string name_of(CalibrationTarget target) {
  switch (target) {
    case CalibrationTarget::kWires:
      return "the wires";
    case CalibrationTarget::kWall:
      return "the floor";
    case CalibrationTarget::kPoint:
      return "the point";
  }
  return {};
}

void SpatialOptions::check() const {
  if (!(max_latency_s >= 0.0 && max_latency_s <= 10.0)) throw Error("the largest latency must be 0 to 10 s");
  if (min_frames < 8) throw Error("a calibration needs at least 8 frames");
  if (!(max_point_sd_mm > 0.0)) throw Error("the largest standard deviation of a point must be above 0 mm");
}

SpatialFit fit_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                       const SpatialState& start, const SpatialMask& fitted, const SpatialOptions& options) {
  SpatialFit fit = robust_fit(poses, observations, start, fitted, options);
  set_covariance(poses, observations, fit, options);
  return fit;
}

std::vector<std::pair<int, double>> cross_validated(const ProbePoses& poses,
                                                    const std::vector<SpatialObservation>& observations,
                                                    const SpatialFit& fit) {
  const std::vector<int> frames = frames_of(observations, fit.used);
  const auto block_of = [&](int frame) {
    const auto at = std::lower_bound(frames.begin(), frames.end(), frame) - frames.begin();
    return static_cast<int>(at * kBlocks / static_cast<std::ptrdiff_t>(frames.size()));
  };
  std::map<int, std::pair<double, int>> sums;
  for (int block = 0; block < kBlocks; ++block) {
    std::vector<bool> kept = fit.used;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (kept[i] && block_of(observations[i].frame) == block) kept[i] = false;
    }
    const SpatialState state =
        solve_spatial(poses, observations, kept, fit.state, fit.fitted, 0.0, 20, std::abs(fit.state.latency_s) + 1.0);
    const SpatialErrors errors = spatial_errors(poses, observations, state);
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (!fit.used[i] || kept[i]) continue;
      auto& sum = sums[observations[i].frame];
      sum.first += errors.error_mm[i].squaredNorm();
      ++sum.second;
    }
  }
  std::vector<std::pair<int, double>> means;
  for (const auto& [frame, sum] : sums) means.emplace_back(frame, sum.first / sum.second);
  return means;
}

SpatialFit calibrate_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const std::vector<SpatialState>& starts, const SpatialOptions& options) {
  options.check();
  const bool latency = options.try_latency && poses.has_times();
  const SpatialMask mask = base_mask(options);
  SpatialMask mask_with_latency = mask;
  mask_with_latency[kLatency] = true;
  // With and without a latency are compared on poses with the same noise.
  const ProbePoses even = latency ? poses.evenly_smoothed() : poses;

  // Starts carry the latency that they were found with; the best of all without and with a free latency.
  std::optional<SpatialFit> plain;
  std::optional<SpatialFit> shifted;
  for (const SpatialState& start : starts) {
    if (start.latency_s == 0.0) keep_better(plain, even, observations, start, mask, options);
    if (latency) keep_better(shifted, even, observations, start, mask_with_latency, options);
  }
  if (!plain && !shifted) throw Error(nothing_fits(poses, options));
  const bool late = !plain || (shifted && predicts_better(even, observations, *plain, *shifted));
  // The latency found is held from here on, and the poses are those that results will be made with: means are also less
  // exact where the probe's way is curved.
  SpatialFit best = robust_fit(poses, observations, late ? shifted->state : plain->state, mask, options);
  if (options.try_skew) {
    SpatialMask skewed = mask;
    skewed[kSkew] = true;
    const SpatialFit fit = robust_fit(poses, observations, best.state, skewed, options);
    if (plausible(fit.state) && fit.frames_used >= options.min_frames &&
        predicts_better(poses, observations, best, fit)) {
      best = fit;
    }
  }
  if (late) best.fitted[kLatency] = true;
  best.parameters = parameters_of(best.fitted);
  set_covariance(poses, observations, best, options);
  return best;
}

Calibration calibration_of(const SpatialFit& fit) {
  Calibration calibration;
  calibration.probe_from_image = fit.state.probe_from_image();
  calibration.latency_s = fit.state.latency_s;
  calibration.rms_mm = fit.rms_mm;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    if (fit.parameters[i] > kLatency) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    calibration.parameters.emplace_back(kSpatialParameterNames[static_cast<std::size_t>(fit.parameters[i])]);
  }
  calibration.covariance = fit.covariance(kept, kept);
  return calibration;
}

}  // namespace fathom
