#include "registration/spatial_calibration_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace fathom {

namespace {

// A frame stands out when its rms is beyond this many medians. With k independent errors a good frame's rms is
// distributed like chi of k: these are its quantile of 99.98 % over its median.
constexpr std::array<double, 4> kOutlyingFrame = {5.5, 3.5, 2.9, 2.6};
constexpr double kOutlyingPoint = 6.0;  // a point's distance, in medians of all
constexpr double kGaussianMedian = 0.6745;
constexpr double kLeastScaleMm = 1e-6;  // perfect data must not divide by nothing

}  // namespace

SpatialErrors spatial_errors(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                             const SpatialState& state) {
  SpatialErrors errors;
  for (const SpatialObservation& observation : observations) {
    const auto at = poses.at(observation.frame, state.latency_s);
    errors.inside.push_back(at && at->inside);
    errors.error_mm.push_back(at ? spatial_error(observation, *at, state, nullptr) : Eigen::Vector3d::Zero());
  }
  return errors;
}

double row_scale(const std::vector<SpatialObservation>& observations, const SpatialErrors& errors,
                 const std::vector<bool>& used) {
  std::vector<double> rows;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!used[i]) continue;
    for (int row = 0; row < observations[i].row_count; ++row) rows.push_back(std::abs(errors.error_mm[i][row]));
  }
  return std::max(kLeastScaleMm, median(std::move(rows)) / kGaussianMedian);
}

std::vector<bool> without_outliers(const std::vector<SpatialObservation>& observations, const SpatialErrors& errors) {
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

}  // namespace fathom
