#include "measurement/carried_planes.h"

#include <cmath>

namespace fathom {

std::optional<SectionPlane> carried_to(const SectionPlane& plane, const Eigen::Vector3d& point,
                                       const Eigen::Vector3d& normal) {
  const Eigen::Vector3d sum = plane.normal() + normal;
  // |sum| is twice the cosine of half of the angle between the normals.
  if (sum.norm() < 2.0 * std::cos(0.5 * kMaxCarryAngle_rad)) return std::nullopt;
  const Eigen::Vector3d average = sum.normalized();
  // Along the average normal one plane is the mirror image of the other, so lengths within the plane are kept.
  const auto mirrored = [&](const Eigen::Vector3d& axis) {
    return Eigen::Vector3d(axis - 2.0 * axis.dot(average) * average);
  };
  SectionPlane carried;
  const double distance = (point - plane.origin_mm).dot(normal) / average.dot(normal);
  carried.origin_mm = plane.origin_mm + distance * average;
  // Rounding would add up over thousands of frames.
  carried.b_axis = normal.cross(mirrored(plane.a_axis)).normalized();
  carried.a_axis = carried.b_axis.cross(normal);
  return carried;
}

std::vector<std::optional<CarriedPlane>> carried_planes(const FrameLocator& locator) {
  std::vector<std::optional<CarriedPlane>> planes(static_cast<std::size_t>(locator.frame_count()));
  std::optional<SectionPlane> before;
  int run = 0;
  for (int frame = 0; frame < locator.frame_count(); ++frame) {
    const auto reference_from_image = locator.reference_from_image(frame);
    if (!reference_from_image) continue;
    const Eigen::Vector3d x_axis = reference_from_image->linear().col(0);
    const Eigen::Vector3d y_axis = reference_from_image->linear().col(1);
    const Eigen::Vector3d normal = x_axis.cross(y_axis).normalized();
    const Eigen::Vector3d first_pixel = reference_from_image->translation();
    std::optional<SectionPlane> plane;
    if (before) plane = carried_to(*before, first_pixel, normal);
    if (!plane) {
      if (before) ++run;
      const Eigen::Vector3d a_axis = x_axis.normalized();
      plane = SectionPlane{first_pixel, a_axis, normal.cross(a_axis)};
    }
    CarriedPlane carried;
    carried.plane = *plane;
    carried.run = run;
    Eigen::Matrix<double, 3, 2> axes;
    axes << plane->a_axis, plane->b_axis;
    carried.ab_from_image.linear().col(0) = axes.transpose() * x_axis;
    carried.ab_from_image.linear().col(1) = axes.transpose() * y_axis;
    carried.ab_from_image.translation() = axes.transpose() * (first_pixel - plane->origin_mm);
    planes[static_cast<std::size_t>(frame)] = carried;
    before = plane;
  }
  return planes;
}

}  // namespace fathom
