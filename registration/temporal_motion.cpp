#include "registration/temporal_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "core/error.h"
#include "core/statistics.h"
#include "registration/temporal_start.h"

namespace fathom {

namespace {

constexpr std::size_t kCoordinates = 6;
constexpr int kRounds = 30;
constexpr double kSettled_s = 1e-6;
constexpr double kLeastPx = 1e-6;  // perfect data must not leave everything out
constexpr double kOutlying = 6.0;  // of the median distance
constexpr double kRoughly = 0.5;   // the correlation that a first look must have

using Coordinates = Eigen::Matrix<double, kCoordinates, 1>;

/// The probe's place (mm) and turn (rad) about their means, as one signal each.
std::array<Signal, kCoordinates> coordinate_signals(const ProbePoses& poses) {
  std::array<Signal, kCoordinates> signals;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  for (const auto& pose : poses.poses()) {
    if (!pose) continue;
    mean += pose->translation() / poses.valid_count();
    turns += pose->linear();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turns, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d middle = svd.matrixU() * svd.matrixV().transpose();
  for (std::size_t i = 0; i < poses.poses().size(); ++i) {
    const auto& pose = poses.poses()[i];
    if (!pose) continue;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(middle.transpose() * pose->linear()));
    Coordinates coordinates;
    coordinates << pose->translation() - mean, turn.angle() * turn.axis();
    for (std::size_t k = 0; k < kCoordinates; ++k) {
      signals[k].source = poses.recording();
      signals[k].values.push_back({poses.times_s()[i], coordinates[static_cast<Eigen::Index>(k)]});
    }
  }
  return signals;
}

/// One moment: the floor's depth, and the probe's coordinates and how they change then.
struct Sample {
  double depth_px = 0.0;
  Coordinates place = Coordinates::Zero();
  Coordinates change = Coordinates::Zero();  ///< per second
};

using Trackers = std::vector<SmoothSignal>;

std::vector<Sample> samples_at(const Signal& image, const Trackers& coordinates, double latency_s) {
  std::vector<Sample> samples;
  for (const TimedValue& value : image.values) {
    Sample sample;
    sample.depth_px = value.value;
    bool known = true;
    for (std::size_t k = 0; k < kCoordinates && known; ++k) {
      const auto at = coordinates[k].at(value.time_s + latency_s);
      known = at.has_value();
      if (!known) break;
      sample.place[static_cast<Eigen::Index>(k)] = at->value;
      sample.change[static_cast<Eigen::Index>(k)] = at->slope;
    }
    if (known) samples.push_back(sample);
  }
  return samples;
}

/// depth(t) = weights . coordinates(t + latency) + offset, near a latency.
struct DepthFit {
  Coordinates weights = Coordinates::Zero();
  double later_s = 0.0;  ///< by how much the latency is more
  double widened = 1.0;  ///< the latency's standard deviation over what it would be with the weights known
};

/// Least squares, without moments that stand out. The latency is held where `before`, the weights of the last round,
/// are not known yet: how fast the depth changes follows from them.
DepthFit fit_depth(std::vector<Sample> samples, const std::optional<Coordinates>& before) {
  constexpr Eigen::Index kOffset = kCoordinates;
  constexpr Eigen::Index kLater = kCoordinates + 1;
  using Vector = Eigen::Matrix<double, kCoordinates + 2, 1>;
  using Matrix = Eigen::Matrix<double, kCoordinates + 2, kCoordinates + 2>;
  constexpr int kRefits = 3;
  DepthFit result;
  for (int refit = 0; refit < kRefits; ++refit) {
    const auto row_of = [&](const Sample& sample) {
      Vector row;
      row << sample.place, 1.0, before ? before->dot(sample.change) : 0.0;
      return row;
    };
    Matrix normal = Matrix::Zero();
    Vector right = Vector::Zero();
    for (const Sample& sample : samples) {
      normal += row_of(sample) * row_of(sample).transpose();
      right += row_of(sample) * sample.depth_px;
    }
    // Turns are numbers a hundred times smaller than places; of one that hardly changes nothing is learnt, and the
    // smallest solution leaves it out.
    const Vector size = normal.diagonal().cwiseMax(1e-12).cwiseSqrt();
    const Matrix scaled = size.cwiseInverse().asDiagonal() * normal * size.cwiseInverse().asDiagonal();
    const auto solver = scaled.completeOrthogonalDecomposition();
    const Vector fit = size.cwiseInverse().asDiagonal() * Vector(solver.solve(size.cwiseInverse().cwiseProduct(right)));
    result.weights = fit.head<kCoordinates>();
    result.later_s = fit[kLater];
    if (before) {
      // With the weights known only scale and offset would be fitted beside the latency.
      Eigen::Matrix<double, kCoordinates + 2, 3> few = Eigen::Matrix<double, kCoordinates + 2, 3>::Zero();
      few.block<kCoordinates, 1>(0, 0) = *before;
      few(kOffset, 1) = few(kLater, 2) = 1.0;
      const double all = Matrix(normal.inverse())(kLater, kLater);
      const double held = Eigen::Matrix3d((few.transpose() * normal * few).inverse())(2, 2);
      if (all > held && std::isfinite(all)) result.widened = std::sqrt(all / held);
    }
    const auto distance = [&](const Sample& sample) { return std::abs(sample.depth_px - row_of(sample).dot(fit)); };
    std::vector<double> distances;
    for (const Sample& sample : samples) distances.push_back(distance(sample));
    const double farthest = std::max(kLeastPx, kOutlying * median(std::move(distances)));
    std::erase_if(samples, [&](const Sample& sample) { return distance(sample) > farthest; });
  }
  return result;
}

/// Where the floor lies under the probe, in mm about the mean.
Signal weighted(const std::array<Signal, kCoordinates>& coordinates, const Coordinates& weights) {
  Signal sum{coordinates[0].source, {}};
  for (std::size_t i = 0; i < coordinates[0].values.size(); ++i) {
    double place = 0.0;
    for (std::size_t k = 0; k < kCoordinates; ++k) {
      place += weights[static_cast<Eigen::Index>(k)] * coordinates[k].values[i].value;
    }
    sum.values.push_back({coordinates[0].values[i].time_s, place});
  }
  return sum;
}

}  // namespace

TemporalCalibration find_latency(const Signal& image, const ProbePoses& tracker, const TemporalOptions& options) {
  options.check();
  TemporalOptions rough = options;
  rough.min_correlation = std::min(options.min_correlation, kRoughly);
  rough.max_stddev_s = std::max(options.max_stddev_s, options.max_latency_s);
  TemporalCalibration found = find_latency(image, motion_signal(tracker), rough);
  const std::array<Signal, kCoordinates> signals = coordinate_signals(tracker);
  const Trackers smooth(signals.begin(), signals.end());
  double latency_s = found.latency_s;
  std::optional<Coordinates> weights;
  double widened = 1.0;
  for (int round = 0; round < kRounds; ++round) {
    const DepthFit fit = fit_depth(samples_at(image, smooth, latency_s), weights);
    if (!fit.weights.allFinite() || !(fit.weights.head<3>().norm() > 0.0)) break;
    weights = fit.weights;
    widened = fit.widened;
    if (round == 0) continue;
    const double step_s = std::clamp(fit.later_s, -2.0 * kLatencyStep_s, 2.0 * kLatencyStep_s);
    latency_s = std::clamp(latency_s + step_s, -options.max_latency_s, options.max_latency_s);
    if (std::abs(step_s) < kSettled_s) break;
  }
  if (!weights) return find_latency(image, motion_signal(tracker), options);
  found = find_latency(image, weighted(signals, *weights / weights->head<3>().norm()), options);
  found.stddev_s *= widened;
  return found;
}

}  // namespace fathom
