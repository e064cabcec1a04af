#include "registration/spatial_calibration_motion.h"

#include <array>
#include <cmath>
#include <numbers>

namespace fathom {

namespace {
constexpr double kStillMm = 1.0;          // a tracker's noise of a probe that lies on the table
constexpr double kTurnedEnoughDeg = 8.0;  // standard deviation: 15 degrees to both sides
constexpr double kHeightEnoughMm = 8.0;   // the same for the distance from a floor: 15 mm up and down
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
  double height = 0.0;
  const Eigen::Vector3d up = state.reference_from_phantom.linear().col(2);
  for (const Eigen::Isometry3d& image : images) {
    const Eigen::AngleAxisd turn(mean.toRotationMatrix().transpose() * image.linear());
    motion.turned_deg += (turn.angle() * turn.axis()).cwiseAbs2();
    const Eigen::Vector3d aside = image.translation() - mean_place;
    moved += aside.squaredNorm();
    height += up.dot(aside) * up.dot(aside);
  }
  motion.turned_deg = (motion.turned_deg / n).cwiseSqrt() * 180.0 / std::numbers::pi;
  motion.moved_mm = std::sqrt(moved / n);
  motion.height_mm = std::sqrt(height / n);
  return motion;
}

std::string movement_from_rest(CalibrationTarget target) {
  constexpr std::array<const char*, 3> kMovements = {
      "sweep along the wires and back, while twisting, tilting and rocking the probe",
      "move the probe nearer to the floor and farther away, rock and tilt it, twist it by a quarter turn, and do so "
      "again",
      "see the point in all parts of the image, from all sides"};
  return kMovements[static_cast<std::size_t>(target)];
}

std::string movement_to_add(const ProbePoses& poses, const std::vector<int>& frames, const SpatialState& state,
                            CalibrationTarget target) {
  const ProbeMotion motion = probe_motion(poses, frames, state);
  if (motion.moved_mm < kStillMm && motion.turned_deg.norm() < 1.0) {
    return "the probe did not move; record again: " + movement_from_rest(target);
  }
  constexpr std::array<const char*, 3> kMovements = {"tilt the probe forwards and backwards",
                                                     "twist the probe about its long axis",
                                                     "rock the probe from side to side"};
  // A floor does not tell a twisted image from a sloping floor unless the probe is turned round over it.
  constexpr double kTwistedOverFloorDeg = 25.0;
  const bool wall = target == CalibrationTarget::kWall;
  std::string advice;
  const auto add = [&advice](const std::string& movement, double now, const char* unit) {
    advice += (advice.empty() ? "" : ", ") + movement + " (now +-" +
              std::to_string(static_cast<int>(std::lround(now))) + " " + unit + ")";
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double enough = wall && axis == 1 ? kTwistedOverFloorDeg : kTurnedEnoughDeg;
    if (motion.turned_deg[axis] >= enough) continue;
    add(kMovements[static_cast<std::size_t>(axis)], motion.turned_deg[axis], "degrees");
  }
  if (wall && motion.height_mm < kHeightEnoughMm) {
    add("move the probe nearer to the floor and farther away", motion.height_mm, "mm");
  }
  if (advice.empty()) {
    return "see " + name_of(target) + " at more places in the image, near and far, left and right; record again";
  }
  return "record again and " + advice;
}

}  // namespace fathom
