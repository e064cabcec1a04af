#pragma once

#include <Eigen/Geometry>

namespace fathom {

/// How the Outline pane looks at space: without perspective, so that a scale bar holds everywhere. View coordinates: x
/// right, y down, z away from the eye, millimetres from `centre_mm`.
struct Camera {
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();  ///< in the pane's middle, and what it turns about
  Eigen::Quaterniond view_from_reference = Eigen::Quaterniond::Identity();
  double mm_per_pixel = 0.5;
  double depth_mm = 1000.0;  ///< what is nearer than this to the centre is drawn

  void turn(double right_px, double down_px) {
    constexpr double kTurn = 0.008;  // radians a pixel
    view_from_reference = Eigen::AngleAxisd(-kTurn * down_px, Eigen::Vector3d::UnitX()) *
                          Eigen::AngleAxisd(kTurn * right_px, Eigen::Vector3d::UnitY()) * view_from_reference;
    view_from_reference.normalize();
  }
  void pan(double right_px, double down_px) {
    centre_mm -= view_from_reference.conjugate() * Eigen::Vector3d(right_px, down_px, 0.0) * mm_per_pixel;
  }
  Eigen::Affine3d view() const { return Eigen::Affine3d(view_from_reference) * Eigen::Translation3d(-centre_mm); }
  /// From the pane's middle, in pixels to the right and down.
  Eigen::Vector2d project(const Eigen::Vector3d& point_mm) const {
    return (view() * point_mm).head<2>() / mm_per_pixel;
  }
  Eigen::Vector3d to_space(const Eigen::Vector2d& view_direction_px) const {
    return view_from_reference.conjugate() * Eigen::Vector3d(view_direction_px.x(), view_direction_px.y(), 0.0) *
           mm_per_pixel;
  }
  Eigen::Matrix4d clip(double width_px, double height_px) const {
    Eigen::Matrix4d scale = Eigen::Matrix4d::Identity();
    scale(0, 0) = 2.0 / (width_px * mm_per_pixel);
    scale(1, 1) = -2.0 / (height_px * mm_per_pixel);
    scale(2, 2) = 1.0 / depth_mm;
    return scale * view().matrix();
  }
};

}  // namespace fathom
