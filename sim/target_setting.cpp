#include "sim/target_setting.h"

#include <cmath>

#include "registration/wire_end_view.h"

namespace fathom {

namespace {

const cv::Size kTargetImageSize{640, 480};
constexpr double kTargetPixel_mm = 0.1;  // over a floor or a point: 64 mm wide, 48 mm deep
constexpr double kPixelAspect = 0.92;    // height by width of a linear probe's pixels: seldom quite square
constexpr double kFaceRadius_mm = 40.0;  // of the curved probe
constexpr double kFanHalfAngle_rad = 0.6;
constexpr double kFanRoom = 1.25;     // a fan needs a larger image for the same target
constexpr double kTremor_rad = 0.02;  // of a hand that means to move up and down only
constexpr double kTremor_mm = 0.5;
constexpr double kClear_mm = 2.0;  // between a target and the edges of what is seen or of the wires

void set_probe(TargetView& view, const std::string& probe, double pixel_mm) {
  view.size = kTargetImageSize;
  view.beam.tissue_db = kWater_db;
  view.beam.attenuation_db_per_mm = 0.0;  // of water
  if (probe == "linear") {
    view.pixel_mm = Eigen::Vector2d(pixel_mm, kPixelAspect * pixel_mm);
    return;
  }
  view.pixel_mm = Eigen::Vector2d::Constant(kFanRoom * pixel_mm);
  const double face_px = kFaceRadius_mm / view.pixel_mm.x();
  view.fan = ProbeFan{face_px * std::cos(kFanHalfAngle_rad), face_px, kFanHalfAngle_rad};
}

/// Of a phantom, in its bath.
struct WireExtent {
  Eigen::Isometry3d phantom_from_bath = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_mm = Eigen::Vector3d::Zero();
};

WireExtent wire_extent(const WirePhantom& phantom) {
  const Eigen::Matrix3d end_view = wire_end_view(phantom).phantom_from_view;
  WireExtent extent;
  const Eigen::Vector3d across = end_view.col(0).normalized();
  const Eigen::Vector3d up = -(end_view.col(2) - end_view.col(2).dot(across) * across).normalized();
  extent.phantom_from_bath.linear() << across, up.cross(across), up;
  Eigen::AlignedBox3d box;
  for (const NPattern& pattern : phantom.patterns) {
    for (const Wire& wire : pattern) {
      for (const Eigen::Vector3d& end : {wire.front, wire.back}) {
        box.extend(extent.phantom_from_bath.linear().transpose() * end);
      }
    }
  }
  extent.phantom_from_bath.translation() = extent.phantom_from_bath.linear() * box.center();
  extent.size_mm = box.sizes();
  return extent;
}

void set_wires(TargetSetting& setting, const TargetScanOptions& options) {
  constexpr double kWidthRoom = 1.7;  // images are so much wider than the wires
  constexpr double kDepthRoom = 1.5;
  constexpr double kDepthMore_mm = 15.0;
  const WireExtent extent = wire_extent(options.phantom);
  const Eigen::Vector3d& size = extent.size_mm;
  setting.phantom_from_bath = extent.phantom_from_bath;
  set_probe(setting.view, options.probe,
            std::max(kWidthRoom * size.x() / kTargetImageSize.width,
                     (kDepthRoom * size.z() + kDepthMore_mm) / (kPixelAspect * kTargetImageSize.height)));
  const Eigen::Vector2d image_mm =
      setting.view.pixel_mm.cwiseProduct(Eigen::Vector2d(kTargetImageSize.width, kTargetImageSize.height));
  setting.anchor_mm = 0.5 * image_mm;
  if (setting.view.fan) setting.anchor_mm.y() = 0.55 * image_mm.y();
  // Turned planes meet the outer wires of the first and last patterns farther along: less turn over short wires.
  Eigen::Vector3d turn(0.3, 0.26, 0.2);
  const auto along = [&] {
    return 0.5 * (size.y() - size.x() * std::tan(turn.x()) - size.z() * std::tan(turn.y())) - 0.5 * kClear_mm;
  };
  while (along() < 0.2 * size.y() && turn.x() > 0.01) turn *= 0.9;
  setting.sway.turn_rad = turn;
  const auto room = [](double image, double target) { return std::max(0.0, 0.5 * (image - target) - kClear_mm); };
  setting.sway.shift_mm = Eigen::Vector3d(0.5 * room(image_mm.x(), size.x()), std::max(0.0, along()),
                                          0.7 * room(image_mm.y(), size.z() + size.x() * std::tan(turn.z())));
}

void set_wall(TargetSetting& setting, const TargetScanOptions& options) {
  set_probe(setting.view, options.probe, kTargetPixel_mm);
  setting.anchor_mm = 0.5 * setting.view.pixel_mm.cwiseProduct(Eigen::Vector2d(640, 560));
  setting.sway = {{1.2, 0.6, 0.6}, {10.0, 10.0, 10.0}};
}

void set_point(TargetSetting& setting, const TargetScanOptions& options) {
  set_probe(setting.view, options.probe, kTargetPixel_mm);
  setting.anchor_mm = 0.5 * setting.view.pixel_mm.cwiseProduct(Eigen::Vector2d(640, 480));
  setting.anchor_sways = true;
  // The bead is held in the beam, not exactly in its middle.
  setting.sway = {{1.2, 0.45, 0.45}, {18.0, 0.3, 15.0}};
}

}  // namespace

TargetSetting target_setting(const TargetScanOptions& options) {
  TargetSetting setting;
  using Set = void (*)(TargetSetting&, const TargetScanOptions&);
  struct Row {
    const char* object;
    Set set;
  };
  constexpr std::array kRows = {Row{"wires", set_wires}, Row{"wall", set_wall}, Row{"point", set_point}};
  for (const Row& row : kRows) {
    if (options.object == row.object) row.set(setting, options);
  }
  setting.view.beam.seed = options.seed;
  if (options.pattern == "floor") {
    setting.sway.turn_rad.setConstant(kTremor_rad);
    setting.sway.shift_mm.head<2>().setConstant(kTremor_mm);
  }
  return setting;
}

}  // namespace fathom
