#include "registration/spatial_calibration_motion.h"

#include <array>
#include <cmath>
#include <numbers>

namespace fathom {

namespace {
constexpr double kStillMm = 1.0;          // a tracker's noise of a probe that lies on the table
constexpr double kTurnedEnoughDeg = 8.0;  // standard deviation: 15 degrees to both sides
}  // namespace

ProbeMotion probe_motion(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state) {
  ProbeMotion motion;
  if (frames.empty()) return motion;
  std::vector<Eigen::Isometry3d> images;
  Eigen::Vector4d mean_turn = Eigen::Vector4d::Zero();
  Eigen::Vector3d mean_place = Eigen::Vector3d::Zero();
  for (const int frame : frames) {
    const auto at = poses.at(frame, state.latency_s);
    if (!at) continue;
    Eigen::Isometry3d image = at->reference_from_probe;
    image.linear() = (image.linear() * state.rotation.toRotationMatrix()).eval();
    Eigen::Vector4d turn = Eigen::Quaterniond(image.linear()).coeffs();
    if (turn.dot(mean_turn) < 0.0) turn = -turn;
    mean_turn += turn;
    mean_place += image.translation();
    images.push_back(image);
  }
  if (images.empty()) return motion;
  const auto n = static_cast<double>(images.size());
  mean_place /= n;
  Eigen::Quaterniond mean;
  mean.coeffs() = mean_turn.normalized();
  double moved = 0.0;
  for (const Eigen::Isometry3d& image : images) {
    const Eigen::AngleAxisd turn(mean.toRotationMatrix().transpose() * image.linear());
    motion.turned_deg += (turn.angle() * turn.axis()).cwiseAbs2();
    moved += (image.translation() - mean_place).squaredNorm();
  }
  motion.turned_deg = (motion.turned_deg / n).cwiseSqrt() * 180.0 / std::numbers::pi;
  motion.moved_mm = std::sqrt(moved / n);
  return motion;
}

std::string movement_to_add(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state) {
  const ProbeMotion motion = probe_motion(poses, frames, state);
  if (motion.moved_mm < kStillMm && motion.turned_deg.norm() < 1.0) {
    return "the probe did not move; record again while moving and turning it";
  }
  constexpr std::array<const char*, 3> kMovements = {"tilt the probe forwards and backwards",
                                                     "twist the probe about its long axis",
                                                     "rock the probe from side to side"};
  std::string advice;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (motion.turned_deg[axis] >= kTurnedEnoughDeg) continue;
    advice += (advice.empty() ? "" : ", ") + std::string(kMovements[static_cast<std::size_t>(axis)]) + " (now +-" +
              std::to_string(static_cast<int>(std::lround(motion.turned_deg[axis]))) + " degrees)";
  }
  if (advice.empty()) return "see the target at more places in the image, near and far, left and right; record again";
  return "record again and " + advice;
}

}  // namespace fathom
