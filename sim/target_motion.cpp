#include "sim/target_motion.h"

#include <cmath>
#include <numbers>

namespace fathom {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// Hertz of a hand's movements: twist, tilt, rock, then the three shifts. No two hang together. Slow enough that poses
// 40 ms apart tell what lies between them: a hundredth of a radian is a millimetre at the image.
constexpr std::array kHertz = {0.17, 0.31, 0.43, 0.21, 0.27, 0.37};
// Of the way up and down: the pace itself sways, so that no stretch repeats within the latencies looked for.
constexpr double kPace_hz = 0.55;
constexpr double kPaceSways_rad = 1.9;
constexpr double kPaceSway_hz = 0.13;
constexpr double kHeightSway = 0.25;  // of the height
constexpr double kHeightSway_hz = 0.19;

}  // namespace

TargetMotion::TargetMotion(const Sway& sway, const Eigen::Vector2d& anchor_mm, bool anchor_sways, bool floor_like,
                           Random random)
    : sway_(sway), anchor_mm_(anchor_mm), anchor_sways_(anchor_sways), floor_like_(floor_like) {
  for (double& phase : phase_) phase = random.uniform(0.0, kTurn);
}

double TargetMotion::up_and_down(double time_s) const {
  const double pace = kTurn * kPace_hz * time_s + kPaceSways_rad * std::sin(kTurn * kPaceSway_hz * time_s + phase_[6]);
  const double height = 1.0 - kHeightSway + kHeightSway * std::sin(kTurn * kHeightSway_hz * time_s + phase_[7]);
  return height * std::sin(pace + phase_[5]);
}

Eigen::Isometry3d TargetMotion::bath_from_image(double time_s) const {
  std::array<double, 6> sway{};
  for (std::size_t i = 0; i < sway.size(); ++i) sway[i] = std::sin(kTurn * kHertz[i] * time_s + phase_[i]);
  if (floor_like_) sway[5] = up_and_down(time_s);
  const Eigen::Vector3d turn = sway_.turn_rad.cwiseProduct(Eigen::Vector3d(sway[0], sway[1], sway[2]));
  const Eigen::Vector3d shift = sway_.shift_mm.cwiseProduct(Eigen::Vector3d(sway[3], sway[4], sway[5]));

  Eigen::Matrix3d upright;  // image x along the bath's x, image y down
  upright << Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitZ()).toRotationMatrix() * upright *
      (Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  Eigen::Vector3d anchor(anchor_mm_.x(), anchor_mm_.y(), 0.0);
  if (anchor_sways_) {
    anchor += Eigen::Vector3d(shift.x(), shift.z(), shift.y());
  } else {
    pose.translation() = shift;
  }
  pose.translation() -= pose.linear() * anchor;
  return pose;
}

}  // namespace fathom
