#include "registration/pivot_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "core/numbers.h"
#include "core/random.h"
#include "core/statistics.h"

namespace fathom {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr int kTrials = 60;             // triples of poses: one of wrong ones among 40 % is certain enough to be missed
constexpr std::size_t kSearched = 150;  // poses that judge a trial
constexpr int kConcentrations = 3;
constexpr int kRefits = 10;
// Distance over the median of all: 6 standard deviations of errors in three directions, 2.7 of errors in one.
constexpr double kOutlying = 4.0;
constexpr double kLeastScaleMm = 1e-6;  // perfect data must not divide by nothing

using Poses = std::vector<Eigen::Isometry3d>;

struct Point {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  double distance(const Eigen::Isometry3d& pose) const { return (pose * tip - pivot).norm(); }
};

// What least squares needs of the poses. With the means R' of R and p' of p, pivot = R' tip + p' and
// (I - R'^T R') tip = R'^T p' - mean(R^T p).
struct Sums {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d turned_place = Eigen::Vector3d::Zero();
  double count = 0.0;

  void add(const Eigen::Isometry3d& pose) {
    turn += pose.linear();
    place += pose.translation();
    turned_place += pose.linear().transpose() * pose.translation();
    count += 1.0;
  }
  /// Its eigenvalues are the mean squared sines, roughly, by which directions of the tool tilted.
  Eigen::Matrix3d spread() const { return Eigen::Matrix3d::Identity() - turn.transpose() * turn / (count * count); }
  std::optional<Point> solve() const {
    const Eigen::LDLT<Eigen::Matrix3d> spread_inverse(spread());
    Point point;
    point.tip = spread_inverse.solve(turn.transpose() * place / (count * count) - turned_place / count);
    point.pivot = (turn * point.tip + place) / count;
    if (!point.tip.allFinite()) return std::nullopt;
    return point;
  }
};

Sums sums_of(const Poses& poses, const std::vector<bool>& used) {
  Sums sums;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (used[i]) sums.add(poses[i]);
  }
  return sums;
}

std::vector<double> distances(const Poses& poses, const Point& point) {
  std::vector<double> result;
  result.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses) result.push_back(point.distance(pose));
  return result;
}

// Evenly chosen, so that all parts of the motion are there.
Poses thinned(const Poses& poses) {
  if (poses.size() <= kSearched) return poses;
  Poses few;
  for (std::size_t i = 0; i < kSearched; ++i) few.push_back(poses[i * poses.size() / kSearched]);
  return few;
}

// The point that the best half of the poses agrees on: three poses at random, then the half that fits best, again.
std::optional<Point> start_of(const Poses& all, std::uint64_t seed) {
  const Poses poses = thinned(all);
  Random random(seed);
  std::optional<Point> best;
  double least = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Sums few;
    for (int i = 0; i < 3; ++i) {
      few.add(poses[static_cast<std::size_t>(random.uniform() * static_cast<double>(poses.size()))]);
    }
    std::optional<Point> point = few.solve();
    double middle = 0.0;
    for (int round = 0; point && round <= kConcentrations; ++round) {
      const std::vector<double> distance = distances(poses, *point);
      middle = median(distance);
      if (best && round == 1 && middle > 10.0 * least) break;  // hopeless
      if (round == kConcentrations) break;
      Sums half;
      for (std::size_t i = 0; i < poses.size(); ++i) {
        if (distance[i] <= middle) half.add(poses[i]);
      }
      point = half.solve();
    }
    if (!point || !std::isfinite(middle) || (best && middle >= least)) continue;
    best = point;
    least = middle;
  }
  return best;
}

std::string triple(const Eigen::Vector3d& v) {
  return "(" + format_rounded(v.x(), 2) + ", " + format_rounded(v.y(), 2) + ", " + format_rounded(v.z(), 2) + ")";
}

/// The same line as `axis`, its largest component positive.
Eigen::Vector3d pointing_up(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

/// How far the direction that tilted least did so; throws where that is too little.
double require_turned(const ProbePoses& tool, const Sums& sums, double min_tilt_deg) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sums.spread());
  const Eigen::Vector3d tilt_deg = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt() * kDegrees;
  if (tilt_deg[2] < min_tilt_deg) {
    throw Error(tool.recording() + ": the tool hardly turned (" + std::to_string(std::lround(tilt_deg[2])) +
                " degrees), so its tip is unknown; rest the tip in a dimple and tilt the tool to all sides");
  }
  if (tilt_deg[0] < min_tilt_deg) {
    throw Error(tool.recording() + ": the tool turned about one axis only, so the tip's place along that axis, " +
                triple(pointing_up(eigen.eigenvectors().col(0))) +
                " of the tool, is unknown; tilt the tool to the other sides too");
  }
  return tilt_deg[0];
}

// Rows and columns of the tip, then the pivot. As for the spatial calibration: A (sum g g^T) A with A = (J^T J)^-1,
// g = J^T (I - H)^(-1/2) e, which errors that differ with direction (a turn's act across the shaft only) need.
void set_covariance(const Poses& poses, const std::vector<bool>& used, const Point& point, PivotCalibration& result) {
  using Jacobian = Eigen::Matrix<double, 3, 6>;
  const auto jacobian_of = [](const Eigen::Isometry3d& pose) {
    Jacobian jacobian;
    jacobian << pose.linear(), -Eigen::Matrix3d::Identity();
    return jacobian;
  };
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (used[i]) normal += jacobian_of(poses[i]).transpose() * jacobian_of(poses[i]);
  }
  const Eigen::Matrix<double, 6, 6> inverse = normal.ldlt().solve(Eigen::Matrix<double, 6, 6>::Identity());
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::MatrixXd errors(result.poses_used, 3);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!used[i]) continue;
    const Jacobian jacobian = jacobian_of(poses[i]);
    const Eigen::Vector3d error = poses[i] * point.tip - point.pivot;
    const Eigen::Matrix3d kept = Eigen::Matrix3d::Identity() - jacobian * inverse * jacobian.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> root(kept);
    const Eigen::Matrix<double, 6, 1> g = jacobian.transpose() * (root.operatorInverseSqrt() * error);
    sum += g * g.transpose();
    errors.row(row++) = error.transpose();
  }
  result.correlated = correlated_neighbours(errors);
  result.covariance = result.correlated * inverse * sum * inverse;
  result.rms_mm = std::sqrt(errors.squaredNorm() / static_cast<double>(result.poses_used));
  result.max_mm = errors.rowwise().norm().maxCoeff();
}

void require_good(const ProbePoses& tool, const PivotCalibration& result, const PivotOptions& options) {
  const bool known = result.covariance.allFinite() && result.tip_in_tool_mm.allFinite() && std::isfinite(result.rms_mm);
  if (!known) {
    throw Error(tool.recording() + ": the poses do not determine the tip; tilt the tool farther and to all sides");
  }
  if (result.rms_mm > options.max_rms_mm || result.poses_used < options.min_share * result.poses_valid) {
    throw Error(tool.recording() + ": the poses agree on no tip (" + std::to_string(result.poses_used) + " of " +
                std::to_string(result.poses_valid) + " to " + std::to_string(std::lround(result.rms_mm)) +
                " mm); keep the tip in its dimple while the recording runs");
  }
  // Not a number where rounding leaves a variance below 0.
  if (!(result.tip_sd_mm().maxCoeff<Eigen::PropagateNaN>() <= options.max_tip_sd_mm)) {
    throw Error(tool.recording() + ": the tip is determined only to " +
                std::to_string(
                    std::lround(std::ceil(result.covariance.diagonal().head<3>().cwiseAbs().cwiseSqrt().maxCoeff()))) +
                " mm; tilt the tool farther and to all sides, and record for longer");
  }
}

}  // namespace

void PivotOptions::check() const {
  if (min_poses < 8) throw Error("pivot calibration: at least 8 poses are needed");
  if (!(min_share >= 0.5 && min_share <= 1.0)) throw Error("pivot calibration: the share must be from 0.5 to 1");
  if (!(min_tilt_deg > 0.0 && min_tilt_deg < 90.0)) throw Error("pivot calibration: the tilt must be 0 to 90 degrees");
  if (!(max_tip_sd_mm > 0.0) || !(max_rms_mm > 0.0)) throw Error("pivot calibration: limits must be above 0 mm");
}

PivotCalibration calibrate_pivot(const ProbePoses& tool, const PivotOptions& options) {
  options.check();
  Poses poses;
  for (const auto& pose : tool.poses()) {
    if (pose) poses.push_back(*pose);
  }
  PivotCalibration result;
  result.poses_valid = static_cast<int>(poses.size());
  if (result.poses_valid < options.min_poses) {
    throw Error(tool.recording() + ": has " + std::to_string(result.poses_valid) +
                " valid poses of the tool, but its tip needs at least " + std::to_string(options.min_poses) +
                "; record for longer, within the tracker's range");
  }
  std::vector<bool> used(poses.size(), true);
  require_turned(tool, sums_of(poses, used), options.min_tilt_deg);
  std::optional<Point> point = start_of(poses, options.seed);
  for (int round = 0; point && round < kRefits; ++round) {
    const std::vector<double> distance = distances(poses, *point);
    const double farthest = std::max(kLeastScaleMm, kOutlying * median(distance));
    const std::vector<bool> before = used;
    for (std::size_t i = 0; i < poses.size(); ++i) used[i] = distance[i] <= farthest;
    if (round > 0 && used == before) break;
    point = sums_of(poses, used).solve();
  }
  if (!point) throw Error(tool.recording() + ": the poses agree on no tip; record again");
  result.poses_used = static_cast<int>(std::count(used.begin(), used.end(), true));
  result.tilt_deg = require_turned(tool, sums_of(poses, used), options.min_tilt_deg);
  result.tip_in_tool_mm = point->tip;
  result.pivot_in_reference_mm = point->pivot;
  set_covariance(poses, used, *point, result);
  require_good(tool, result, options);
  return result;
}

}  // namespace fathom
