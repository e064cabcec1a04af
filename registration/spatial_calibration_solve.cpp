#include "registration/spatial_calibration_solve.h"

#include <algorithm>
#include <memory>

#include <ceres/ceres.h>

namespace fathom {

namespace {

// A state as Ceres keeps it. Jacobians are written with respect to SpatialState::moved's change, in the first columns,
// and the manifold's own is the identity there: the chain rule then holds without a quaternion's derivatives.
constexpr int kAmbient = 18;

void pack(const SpatialState& state, double* x) {
  Eigen::Map<Eigen::Vector3d>(x + 0) = state.translation_mm;
  Eigen::Map<Eigen::Vector4d>(x + 3) = state.rotation.coeffs();
  x[7] = state.log_sx;
  x[8] = state.log_sy;
  x[9] = state.skew;
  x[10] = state.latency_s;
  Eigen::Map<Eigen::Vector3d>(x + 11) = state.reference_from_phantom.translation();
  Eigen::Map<Eigen::Vector4d>(x + 14) = Eigen::Quaterniond(state.reference_from_phantom.linear()).coeffs();
}

SpatialState unpack(const double* x) {
  SpatialState state;
  state.translation_mm = Eigen::Map<const Eigen::Vector3d>(x);
  state.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(x + 3);
  state.log_sx = x[7];
  state.log_sy = x[8];
  state.skew = x[9];
  state.latency_s = x[10];
  state.reference_from_phantom.translation() = Eigen::Map<const Eigen::Vector3d>(x + 11);
  Eigen::Quaterniond phantom;
  phantom.coeffs() = Eigen::Map<const Eigen::Vector4d>(x + 14);
  state.reference_from_phantom.linear() = phantom.normalized().toRotationMatrix();
  return state;
}

class StateManifold : public ceres::Manifold {
 public:
  StateManifold(const SpatialMask& fitted, double max_latency_s) : max_latency_s_(max_latency_s) {
    for (int i = 0; i < kSpatialParameters; ++i) {
      if (fitted[static_cast<std::size_t>(i)]) free_.push_back(i);
    }
  }
  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return static_cast<int>(free_.size()); }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    SpatialVector change = SpatialVector::Zero();
    for (std::size_t i = 0; i < free_.size(); ++i) change[free_[i]] = delta[i];
    SpatialState state = unpack(x).moved(change);
    state.latency_s = std::clamp(state.latency_s, -max_latency_s_, max_latency_s_);
    // Far outside of what scanners have, but a wild step from a bad start must not overflow.
    constexpr double kSmallest = -9.0;
    constexpr double kLargest = 4.0;
    state.log_sx = std::clamp(state.log_sx, kSmallest, kLargest);
    state.log_sy = std::clamp(state.log_sy, kSmallest, kLargest);
    pack(state, x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    std::fill_n(jacobian, kAmbient * TangentSize(), 0.0);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      jacobian[static_cast<std::size_t>(free_[i]) * free_.size() + i] = 1.0;
    }
    return true;
  }
  // Asked for only by methods that are not used here.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }

 private:
  std::vector<int> free_;
  double max_latency_s_;
};

class ObservationCost : public ceres::CostFunction {
 public:
  ObservationCost(const ProbePoses& poses, const SpatialObservation& observation, bool latency)
      : poses_(poses), observation_(observation), latency_(latency) {
    set_num_residuals(observation.row_count);
    mutable_parameter_block_sizes()->push_back(kAmbient);
  }
  void settle(double latency_s) { at_ = *poses_.at(observation_.frame, latency_s); }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const SpatialState state = unpack(parameters[0]);
    const ProbePoses::At at = latency_ ? *poses_.at(observation_.frame, state.latency_s) : at_;
    Eigen::Matrix<double, 3, kSpatialParameters> jacobian;
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    const Eigen::Vector3d error = spatial_error(observation_, at, state, wanted ? &jacobian : nullptr);
    for (int row = 0; row < observation_.row_count; ++row) {
      residuals[row] = error[row];
      if (!wanted) continue;
      double* out = jacobians[0] + row * kAmbient;
      for (int i = 0; i < kSpatialParameters; ++i) out[i] = jacobian(row, i);
      std::fill(out + kSpatialParameters, out + kAmbient, 0.0);
    }
    return true;
  }

 private:
  const ProbePoses& poses_;
  const SpatialObservation& observation_;
  bool latency_;
  ProbePoses::At at_;
};

}  // namespace

SpatialState solve_spatial(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                           const std::vector<bool>& used, const SpatialState& start, const SpatialMask& fitted,
                           double loss_mm, int iterations, double max_latency_s) {
  std::array<double, kAmbient> x{};
  pack(start, x.data());
  StateManifold manifold(fitted, max_latency_s);
  const std::unique_ptr<ceres::LossFunction> loss(loss_mm > 0.0 ? new ceres::CauchyLoss(loss_mm) : nullptr);
  std::vector<std::unique_ptr<ObservationCost>> costs;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.disable_all_safety_checks = true;
  ceres::Problem problem(ownership);
  problem.AddParameterBlock(x.data(), kAmbient, &manifold);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!used[i]) continue;
    costs.push_back(std::make_unique<ObservationCost>(poses, observations[i], fitted[kLatency]));
    costs.back()->settle(start.latency_s);
    problem.AddResidualBlock(costs.back().get(), loss.get(), x.data());
  }
  if (costs.empty()) return start;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // results must not depend on the number of threads
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return unpack(x.data());
}

}  // namespace fathom
