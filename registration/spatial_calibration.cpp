#include "registration/spatial_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "core/numbers.h"
#include "core/statistics.h"
#include "registration/spatial_calibration_motion.h"
#include "registration/spatial_calibration_solve.h"

namespace fathom {

namespace {

// A frame stands out when its rms is beyond this many medians. With k independent errors a good frame's rms is
// distributed like chi of k: these are its quantile of 99.98 % over its median.
constexpr std::array<double, 4> kOutlyingFrame = {5.5, 3.5, 2.9, 2.6};
constexpr double kOutlyingPoint = 6.0;  // a point's distance, in medians of all
constexpr double kGaussianMedian = 0.6745;
constexpr double kCauchyScale = 2.4;    // 95 % as efficient as plain squares under Gaussian errors
constexpr double kLeastScaleMm = 1e-6;  // perfect data must not divide by nothing
constexpr int kRounds = 8;
constexpr int kBlocks = 10;                  // of frames that follow each other, left out in turn
constexpr double kBetterBeyondChance = 2.0;  // standard errors of the paired difference
constexpr double kBetterAtAll = 0.01;        // of the mean squared distance: less is not worth a parameter

struct Errors {
  std::vector<Eigen::Vector3d> error_mm;
  std::vector<bool> inside;
};

Errors errors_of(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                 const SpatialState& state) {
  Errors errors;
  for (const SpatialObservation& observation : observations) {
    const auto at = poses.at(observation.frame, state.latency_s);
    errors.inside.push_back(at && at->inside);
    errors.error_mm.push_back(at ? spatial_error(observation, *at, state, nullptr) : Eigen::Vector3d::Zero());
  }
  return errors;
}

double row_scale(const std::vector<SpatialObservation>& observations, const Errors& errors,
                 const std::vector<bool>& used) {
  std::vector<double> rows;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!used[i]) continue;
    for (int row = 0; row < observations[i].row_count; ++row) rows.push_back(std::abs(errors.error_mm[i][row]));
  }
  return std::max(kLeastScaleMm, median(std::move(rows)) / kGaussianMedian);
}

std::vector<bool> without_outliers(const std::vector<SpatialObservation>& observations, const Errors& errors) {
  struct Frame {
    double squares = 0.0;
    int rows = 0;
  };
  std::map<int, Frame> frames;
  std::vector<double> points;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!errors.inside[i]) continue;
    Frame& frame = frames[observations[i].frame];
    frame.squares += errors.error_mm[i].squaredNorm();
    frame.rows += observations[i].row_count;
    points.push_back(errors.error_mm[i].norm());
  }
  // One wrong point must not condemn a frame of nine: it goes first.
  const double farthest_point = std::max(kLeastScaleMm, kOutlyingPoint * median(std::move(points)));
  std::vector<bool> used(observations.size(), false);
  std::map<int, int> points_left_out;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!errors.inside[i]) continue;
    used[i] = errors.error_mm[i].norm() <= farthest_point;
    if (used[i]) continue;
    Frame& frame = frames[observations[i].frame];
    frame.squares -= errors.error_mm[i].squaredNorm();
    frame.rows -= observations[i].row_count;
  }
  std::vector<double> rms;
  for (const auto& [number, frame] : frames) {
    if (frame.rows > 0) rms.push_back(std::sqrt(std::max(0.0, frame.squares) / frame.rows));
  }
  const double usual = std::max(kLeastScaleMm, median(std::move(rms)));
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!used[i]) continue;
    const Frame& frame = frames[observations[i].frame];
    const auto freedom = static_cast<std::size_t>(std::clamp(frame.rows / 2, 1, 4)) - 1;
    used[i] = std::sqrt(std::max(0.0, frame.squares) / frame.rows) <= usual * kOutlyingFrame[freedom];
  }
  return used;
}

std::vector<int> frames_of(const std::vector<SpatialObservation>& observations, const std::vector<bool>& used) {
  std::vector<int> frames;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (used[i]) frames.push_back(observations[i].frame);
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

struct FrameRows {
  Eigen::VectorXd errors;
  Eigen::MatrixXd jacobian;
};

// Rows of all observations of a frame together, columns of the fitted parameters only.
std::map<int, FrameRows> rows_by_frame(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                                       const SpatialFit& fit) {
  std::map<int, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (fit.used[i]) members[observations[i].frame].push_back(i);
  }
  const auto columns = static_cast<Eigen::Index>(fit.parameters.size());
  std::map<int, FrameRows> frames;
  for (const auto& [number, indices] : members) {
    Eigen::Index rows = 0;
    for (const std::size_t i : indices) rows += observations[i].row_count;
    FrameRows& frame = frames[number];
    frame.errors.resize(rows);
    frame.jacobian.resize(rows, columns);
    const auto at = poses.at(number, fit.state.latency_s);
    Eigen::Index row = 0;
    for (const std::size_t i : indices) {
      Eigen::Matrix<double, 3, kSpatialParameters> jacobian;
      const Eigen::Vector3d error = spatial_error(observations[i], *at, fit.state, &jacobian);
      for (int k = 0; k < observations[i].row_count; ++k, ++row) {
        frame.errors[row] = error[k];
        for (Eigen::Index c = 0; c < columns; ++c) {
          frame.jacobian(row, c) = jacobian(k, fit.parameters[static_cast<std::size_t>(c)]);
        }
      }
    }
  }
  return frames;
}

// Covariance of parameters whose errors hang together within frames: A (sum g g^T) A, A = (J^T J)^-1, g = J_f^T e_f.
// Residuals are smaller than errors, as the fit follows them; (I - H_f)^(-1/2), H_f = J_f A J_f^T, undoes that. It is
// applied as a series, for H_f is small where there are many more frames than parameters.
void set_covariance(const ProbePoses& poses, const std::vector<SpatialObservation>& observations, SpatialFit& fit,
                    const SpatialOptions& options) {
  const auto frames = rows_by_frame(poses, observations, fit);
  const auto n = static_cast<Eigen::Index>(fit.parameters.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  double squares = 0.0;
  Eigen::Index rows = 0;
  for (const auto& [number, frame] : frames) {
    normal += frame.jacobian.transpose() * frame.jacobian;
    squares += frame.errors.squaredNorm();
    rows += frame.errors.size();
  }
  // Scaled to a diagonal of ones, so that units do not count.
  const Eigen::VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * normal * size.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  constexpr double kSingular = 1e-11;
  if (eigen.eigenvalues()[0] < kSingular || !eigen.eigenvectors().allFinite()) {
    throw Error(poses.recording() + ": the motion does not determine the calibration: " +
                movement_to_add(poses, frames_of(observations, fit.used), fit.state));
  }
  const Eigen::MatrixXd inverse =
      size.cwiseInverse().asDiagonal() *
      (eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose()) *
      size.cwiseInverse().asDiagonal();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [number, frame] : frames) {
    const Eigen::MatrixXd square = frame.jacobian.transpose() * frame.jacobian * inverse;
    const Eigen::VectorXd g0 = frame.jacobian.transpose() * frame.errors;
    const Eigen::VectorXd g1 = square * g0;
    const Eigen::VectorXd g2 = square * g1;
    const Eigen::VectorXd g3 = square * g2;
    const Eigen::VectorXd g = g0 + 0.5 * g1 + 0.375 * g2 + 0.3125 * g3;
    sum += g * g.transpose();
  }
  fit.covariance = inverse * sum * inverse;
  fit.covariance = (0.5 * (fit.covariance + fit.covariance.transpose())).eval();
  // The place of a pixel seen: how its error there depends on the calibration's own parameters.
  fit.worst_point_sd_mm = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!fit.used[i]) continue;
    SpatialObservation place = observations[i];
    place.rows = Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 3, kSpatialParameters> jacobian;
    spatial_error(place, ProbePoses::At{}, fit.state, &jacobian);
    Eigen::MatrixXd own(3, n);
    for (Eigen::Index c = 0; c < n; ++c) {
      const int parameter = fit.parameters[static_cast<std::size_t>(c)];
      own.col(c) = parameter < kLatency ? Eigen::Vector3d(jacobian.col(parameter)) : Eigen::Vector3d::Zero();
    }
    fit.worst_point_sd_mm =
        std::max(fit.worst_point_sd_mm, std::sqrt((own * fit.covariance * own.transpose()).trace()));
  }
  fit.rms_mm = 0.0;
  const auto points = std::count(fit.used.begin(), fit.used.end(), true);
  if (points > 0) fit.rms_mm = std::sqrt(squares / static_cast<double>(points));
  if (fit.worst_point_sd_mm > options.max_point_sd_mm) {
    throw Error(poses.recording() + ": the motion determines the calibration only to " +
                std::to_string(static_cast<int>(std::ceil(fit.worst_point_sd_mm))) +
                " mm: " + movement_to_add(poses, frames_of(observations, fit.used), fit.state));
  }
}

SpatialFit robust_fit(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                      const SpatialState& start, const SpatialMask& fitted, const SpatialOptions& options) {
  SpatialFit fit;
  fit.state = start;
  fit.fitted = fitted;
  for (int i = 0; i < kSpatialParameters; ++i) {
    if (fitted[static_cast<std::size_t>(i)]) fit.parameters.push_back(i);
  }
  constexpr int kLossRounds = 3;
  for (int round = 0; round < kLossRounds; ++round) {
    const Errors errors = errors_of(poses, observations, fit.state);
    fit.used = errors.inside;
    const double scale = kCauchyScale * row_scale(observations, errors, fit.used);
    fit.state = solve_spatial(poses, observations, fit.used, fit.state, fitted, scale, 20, options.max_latency_s);
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<bool> before = fit.used;
    fit.used = without_outliers(observations, errors_of(poses, observations, fit.state));
    if (round > 0 && fit.used == before) break;
    fit.state = solve_spatial(poses, observations, fit.used, fit.state, fitted, 0.0, 30, options.max_latency_s);
  }
  fit.frames_used = static_cast<int>(frames_of(observations, fit.used).size());
  fit.frames_seen = static_cast<int>(frames_of(observations, std::vector<bool>(observations.size(), true)).size());
  return fit;
}

// The median of frames' rms over the pixel's size: in pixels, or shrinking the image to a point would win.
double badness(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
               const SpatialState& state) {
  const Errors errors = errors_of(poses, observations, state);
  std::vector<double> distances;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (errors.inside[i]) distances.push_back(errors.error_mm[i].norm());
  }
  if (distances.empty()) return std::numeric_limits<double>::infinity();
  return median(std::move(distances)) / std::exp(0.5 * (state.log_sx + state.log_sy));
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

}  // namespace

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
    const Errors errors = errors_of(poses, observations, state);
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
  SpatialMask mask = base_mask(options);
  SpatialMask mask_with_latency = mask;
  mask_with_latency[kLatency] = true;

  // Starts carry the latency that they were found with; the best of all without and with a free latency.
  std::optional<SpatialFit> plain;
  std::optional<SpatialFit> shifted;
  const auto try_fit = [&](std::optional<SpatialFit>& best, const SpatialState& start, const SpatialMask& fitted) {
    SpatialFit fit = robust_fit(poses, observations, start, fitted, options);
    if (!plausible(fit.state) || fit.frames_used < options.min_frames) return;
    if (!best || badness(poses, observations, fit.state) < badness(poses, observations, best->state)) {
      best = std::move(fit);
    }
  };
  for (const SpatialState& start : starts) {
    if (start.latency_s == 0.0) try_fit(plain, start, mask);
    if (latency) try_fit(shifted, start, mask_with_latency);
  }
  if (!plain && !shifted) {
    throw Error(poses.recording() + ": no calibration fits what was seen (fewer than " +
                std::to_string(options.min_frames) +
                " frames agree); check that the phantom's file is that of the phantom scanned, and record again");
  }
  SpatialFit best = plain ? *plain : *shifted;
  if (plain && shifted) {
    SpatialFit compared = *plain;
    compared.used = shifted->used;  // both are judged on the same frames
    for (std::size_t i = 0; i < compared.used.size(); ++i) {
      const auto at = poses.at(observations[i].frame, 0.0);
      compared.used[i] = compared.used[i] && at && at->inside;
    }
    SpatialFit other = *shifted;
    other.used = compared.used;
    if (better_beyond_chance(cross_validated(poses, observations, compared),
                             cross_validated(poses, observations, other))) {
      best = *shifted;
    }
  }
  if (options.try_skew) {
    SpatialMask skewed = best.fitted;
    skewed[kSkew] = true;
    SpatialFit fit = robust_fit(poses, observations, best.state, skewed, options);
    if (plausible(fit.state) && fit.frames_used >= options.min_frames) {
      SpatialFit compared = best;
      compared.used = fit.used;
      if (better_beyond_chance(cross_validated(poses, observations, compared),
                               cross_validated(poses, observations, fit))) {
        best = fit;
      }
    }
  }
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
