#include "cli/image_area.h"

#include <numbers>

namespace fathom {

std::optional<cv::Rect> ImageArea::rectangle() const {
  if (clip.empty()) return std::nullopt;
  return cv::Rect(clip[0], clip[1], clip[2], clip[3]);
}

std::optional<Fan> ImageArea::fan(const Calibration& calibration) const {
  if (sector.empty()) return std::nullopt;
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  Fan fan;
  fan.origin_px = {sector[0], sector[1]};
  fan.min_radius_px = sector[2];
  fan.max_radius_px = sector[3];
  fan.min_angle_rad = sector[4] * kRadPerDeg;
  fan.max_angle_rad = sector[5] * kRadPerDeg;
  const Eigen::Matrix3d& mm_from_px = calibration.probe_from_image.linear();
  fan.pixel_aspect = mm_from_px.col(0).norm() / mm_from_px.col(1).norm();
  return fan;
}

void add_image_area(CLI::App& command, ImageArea& area) {
  command.add_option("--clip", area.clip, "The part of the images to use: x,y,width,height in pixels")
      ->delimiter(',')
      ->expected(4);
  command
      .add_option("--fan", area.sector,
                  "What a curved probe shows: x,y of the point where its scan lines meet, least and largest distance "
                  "from there, all in pixels, and the least and largest angle in degrees, to the right of straight "
                  "down")
      ->delimiter(',')
      ->expected(6);
}

}  // namespace fathom
