#include "sim/scan_path.h"

#include <cmath>
#include <numbers>

#include "sim/choice.h"
#include "sim/scan_table.h"

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
// How far a plane that only touches is moved off the object, so that rounding cannot make a section of it, and how far
// one that would lie in a flat face is moved into the object, so that it sees the face.
constexpr double kClearance_mm = 1e-9;
constexpr double kFaceDepth_mm = 1e-6;
constexpr double kFanDepth = 0.12;     // of the image's height, where a fan's axis lies in the image
constexpr double kPartFanStep = 1e-5;  // rad, to which a fan is turned to the edge of a part; edges are coarser

Eigen::Matrix3d rotation(const Eigen::Matrix3d& view, const ScanPlane& plane) {
  return view * (Eigen::AngleAxisd(plane.azimuth_rad, Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(plane.elevation_rad, Eigen::Vector3d::UnitX()) *
                 Eigen::AngleAxisd(plane.roll_rad, Eigen::Vector3d::UnitZ()))
                    .toRotationMatrix();
}

ScanPlane turned(const Eigen::Vector3d& angles_deg) {
  return {Eigen::Vector3d::Zero(), angles_deg.x() * kRadian, angles_deg.y() * kRadian, angles_deg.z() * kRadian};
}

struct Touch {
  ScanPlane plane;
  std::optional<Eigen::Vector3d> point_mm;
};

std::optional<Eigen::Vector3d> touching_point(const PartContact& contact) {
  if (!contact.whole || contact.on_face) return std::nullopt;
  return contact.point_mm;
}

/// Moves a plane along its normal until it touches; `side` is -1 for a first plane, +1 for a last. Its reference point
/// is the foot of the perpendicular from the object's middle.
Touch touch(const SolidPart& part, const Eigen::Matrix3d& view, double side, ScanPlane plane) {
  const Eigen::Vector3d outward = side * rotation(view, plane).col(2);
  const PartContact contact = part.contact(outward);
  const double clearance = contact.on_face ? -kFaceDepth_mm : contact.whole ? kClearance_mm : -part.inset_mm();
  plane.position_mm = (contact.point_mm.dot(outward) + clearance) * outward;
  return {plane, touching_point(contact)};
}

/// Turns a plane about the fan's axis, where it already lies, until it touches.
Touch tilt(const SolidPart& part, const Eigen::Matrix3d& view, double side, ScanPlane plane) {
  const auto contact_at = [&](double elevation_rad) {
    plane.elevation_rad = elevation_rad;
    return part.contact(side * rotation(view, plane).col(2));
  };
  const auto beyond_mm = [&](double elevation_rad) {
    const PartContact contact = contact_at(elevation_rad);
    const double height = (contact.point_mm - plane.position_mm).dot(side * rotation(view, plane).col(2));
    return contact.whole ? height + kClearance_mm : height - part.inset_mm();
  };
  // Looking along depth the solid lies on both sides of the plane; at a right angle to it, behind the plane.
  double cutting = part.is_whole() ? 0.0 : -side * std::numbers::pi / 2.0;  // a part may lie beside that line
  double clear = side * std::numbers::pi / 2.0;
  const double smallest_rad = part.is_whole() ? 1e-14 : kPartFanStep;
  while (std::abs(clear - cutting) > smallest_rad) {
    const double middle = (cutting + clear) / 2.0;
    if (middle == cutting || middle == clear) break;
    (beyond_mm(middle) > 0.0 ? cutting : clear) = middle;
  }
  const PartContact contact = contact_at(clear);
  return {plane, touching_point(contact)};
}

}  // namespace

ScanPlane ScanPlane::operator+(const ScanPlane& other) const {
  return {position_mm + other.position_mm, azimuth_rad + other.azimuth_rad, elevation_rad + other.elevation_rad,
          roll_rad + other.roll_rad};
}

ScanPlane ScanPlane::operator*(double factor) const {
  return {position_mm * factor, azimuth_rad * factor, elevation_rad * factor, roll_rad * factor};
}

ScanPlane ScanPath::at(double u) const {
  if (u == 0.0) return first;
  if (u == 1.0) return last;  // exactly, so that it touches
  return first * (1.0 - u) + last * u;
}

Eigen::Affine3d ScanPath::phantom_from_image(const ScanPlane& plane, const Eigen::Vector2d& pixel_mm) const {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  const Eigen::Vector3d scale(pixel_mm.x(), pixel_mm.y(), pixel_mm.mean());
  result.linear() = rotation(view, plane) * scale.asDiagonal();
  result.translation() = plane.position_mm - result.linear() * Eigen::Vector3d(anchor_px.x(), anchor_px.y(), 0.0);
  return result;
}

ScanPath make_scan_path(const Phantom& phantom, const ScanGeometry& geometry, const SolidPart& part,
                        cv::Size image_size) {
  ScanPath path;
  path.view << geometry.depth.cross(geometry.sweep), geometry.depth, geometry.sweep;
  path.first = turned(geometry.first_deg);
  path.last = turned(geometry.last_deg);
  const auto extent_mm = [&](const Eigen::Vector3d& direction) {
    return phantom.solid->contact(direction).point_mm.dot(direction);
  };
  // Not in the middle of a pixel, where points of contact would often fall.
  path.anchor_px = Eigen::Vector2d(image_size.width * 0.5 + 0.23, image_size.height * 0.5 + 0.37);
  if (geometry.across != 0.0) {
    path.anchor_px.x() -= geometry.across * extent_mm(path.view.col(0)) / phantom.pixel_mm.x();
  }
  auto place = touch;
  if (geometry.fan_axis) {
    path.anchor_px.y() = image_size.height * kFanDepth;
    path.first.position_mm = path.last.position_mm = -*geometry.fan_axis * extent_mm(-geometry.depth) * geometry.depth;
    place = tilt;
  }
  const Touch first = place(part, path.view, -1.0, path.first);
  const Touch last = place(part, path.view, 1.0, path.last);
  path.first = first.plane;
  path.last = last.plane;
  path.first_touch_mm = first.point_mm;
  path.last_touch_mm = last.point_mm;
  return path;
}

ScanPath make_scan_path(const Phantom& phantom, const std::string& pattern) {
  const ScanGeometry* chosen = nullptr;
  for (const ScanGeometry& geometry : scan_table()) {
    if (pattern != geometry.pattern) continue;
    const bool is_own = phantom.name == geometry.object;
    if (is_own || (chosen == nullptr && std::string(geometry.object).empty())) chosen = &geometry;
    if (is_own) break;
  }
  if (chosen == nullptr) refuse_choice("pattern", pattern, single_sweep_patterns());
  return make_scan_path(phantom, *chosen, SolidPart(*phantom.solid), phantom.image_size);
}

std::vector<std::string> single_sweep_patterns() {
  std::vector<std::string> names;
  for (const ScanGeometry& geometry : scan_table()) {
    if (std::string(geometry.object).empty()) names.emplace_back(geometry.pattern);
  }
  return names;
}

}  // namespace fathom
