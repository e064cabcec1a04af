#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "sim/speckle.h"

namespace fathom {

/// The sector that a curved probe sees, in pixels as blacken_outside_fan has it.
struct ProbeFan {
  double apex_px = 0.0;         ///< of the scan lines, above the image's top edge, in the middle column
  double face_px = 0.0;         ///< radius of the probe's face about the apex
  double half_angle_rad = 0.0;  ///< to both sides of straight down
};

/// How a simulated probe shows targets in a water bath. Lengths are millimetres in the image's own axes: x right, y
/// down, z across the image (x cross y), with the origin at the first pixel's centre.
struct TargetView {
  cv::Size size;
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Ones();  ///< width and height
  std::optional<ProbeFan> fan;                         ///< empty: a linear probe, all scan lines straight down
  SpeckleOptions beam;  ///< resolution, dynamic range; `tissue_db` is the level of what floats in the water
};

/// Levels of echoes across the beam below white. Real ones differ with gain; these leave the peaks unsaturated.
inline constexpr double kWire_db = -5.0;
inline constexpr double kPoint_db = -5.0;
inline constexpr double kFloor_db = -5.0;
inline constexpr double kWater_db = -48.0;  ///< what floats in it, and noise

/// The direction of the beam at a place of the image, unit: straight down, or away from the fan's apex.
Eigen::Vector2d beam_at(const TargetView& view, const Eigen::Vector2d& x_mm);

/// Whether a pixel lies in the image, by `margin_px` or more, and in the probe's sector.
bool shows(const TargetView& view, const Eigen::Vector2d& x_px, double margin_px);

/// Adds the echo of a thin straight wire that cuts the image at `cut_mm` in direction `along` (unit) to `amplitude`
/// (CV_32FC1, 1 is white). The response to a point is Gaussian (SpeckleOptions); that to a wire is its sum along the
/// wire, so that a wire that leans along the image is drawn out by the beam's thickness. Its maximum and its centroid
/// are at `cut_mm`. Specular: it fades as the wire turns along the beam.
void add_wire_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector2d& cut_mm,
                   const Eigen::Vector3d& along);

/// The same of a bead at `place_mm`; it fades with its distance from the image plane as the beam's thickness says.
void add_point_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector3d& place_mm);

/// The same of a flat floor: `up` (unit) points out of it, towards the probe, and up . x = `offset_mm` on it. A bright
/// line, broadened by the beam's thickness where the probe is tilted, fading as it turns away from the beam; a tail
/// that rings down below, and reverberations within the plate. The line's ridge lies on the floor. `texture` (CV_32FC1,
/// mean square 1) makes it rough.
void add_floor_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector3d& up, double offset_mm,
                    const cv::Mat& texture);

}  // namespace fathom
