#include "registration/spatial_calibration_covariance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <Eigen/Eigenvalues>

#include "core/error.h"
#include "core/statistics.h"
#include "registration/spatial_calibration_errors.h"
#include "registration/spatial_calibration_motion.h"

namespace fathom {

namespace {

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

}  // namespace

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
  const auto require_determined = [&](bool determined) {
    if (determined) return;
    throw Error(poses.recording() + ": the motion does not determine the calibration: " +
                movement_to_add(poses, frames_of(observations, fit.used), fit.state, options.target));
  };
  // Written so that what is not a number fails too.
  require_determined(eigen.eigenvalues()[0] >= kSingular && eigen.eigenvectors().allFinite());
  const Eigen::MatrixXd inverse =
      size.cwiseInverse().asDiagonal() *
      (eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose()) *
      size.cwiseInverse().asDiagonal();
  Eigen::MatrixXd gradients(static_cast<Eigen::Index>(frames.size()), n);
  Eigen::Index at_frame = 0;
  for (const auto& [number, frame] : frames) {
    const Eigen::MatrixXd square = frame.jacobian.transpose() * frame.jacobian * inverse;
    const Eigen::VectorXd g0 = frame.jacobian.transpose() * frame.errors;
    const Eigen::VectorXd g1 = square * g0;
    const Eigen::VectorXd g2 = square * g1;
    const Eigen::VectorXd g3 = square * g2;
    const Eigen::VectorXd g = g0 + 0.5 * g1 + 0.375 * g2 + 0.3125 * g3;
    gradients.row(at_frame++) = g.transpose();
  }
  const Eigen::MatrixXd sum = gradients.transpose() * gradients;
  // In units of what the frames tell of each parameter: a parameter that the noise hardly touches must not count.
  const double together = correlated_neighbours(gradients * size.cwiseInverse().asDiagonal());
  fit.covariance = together * inverse * sum * inverse;
  fit.covariance = (0.5 * (fit.covariance + fit.covariance.transpose())).eval();
  require_determined(fit.covariance.allFinite() && std::isfinite(squares));
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
        std::max(fit.worst_point_sd_mm, std::sqrt(std::max(0.0, (own * fit.covariance * own.transpose()).trace())));
  }
  fit.rms_mm = 0.0;
  const auto points = std::count(fit.used.begin(), fit.used.end(), true);
  if (points > 0) fit.rms_mm = std::sqrt(squares / static_cast<double>(points));
  if (fit.worst_point_sd_mm > options.max_point_sd_mm) {
    throw Error(poses.recording() + ": the motion determines the calibration only to " +
                std::to_string(static_cast<int>(std::ceil(fit.worst_point_sd_mm))) +
                " mm: " + movement_to_add(poses, frames_of(observations, fit.used), fit.state, options.target));
  }
}

}  // namespace fathom
