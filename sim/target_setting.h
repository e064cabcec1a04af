#pragma once

#include "sim/target_motion.h"
#include "sim/target_scan.h"

namespace fathom {

/// How a target is scanned: the depth setting, the hand's movements, and where the bath is.
struct TargetSetting {
  TargetView view;
  Sway sway;
  Eigen::Vector2d anchor_mm = Eigen::Vector2d::Zero();  ///< as TargetMotion has it
  bool anchor_sways = false;
  Eigen::Isometry3d phantom_from_bath = Eigen::Isometry3d::Identity();
};

/// The image holds the target with room to move; the hand turns and moves as far as that, and the wires' lengths,
/// allow. `options` are checked.
TargetSetting target_setting(const TargetScanOptions& options);

}  // namespace fathom
