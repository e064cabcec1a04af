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
constexpr double kFanDepth = 0.12;  // of the image's height, where a fan's axis lies in the image

Eigen::Matrix3d rotation(const Eigen::Matrix3d& view, const ScanPlane& plane) {
  return view * (Eigen::AngleAxisd(plane.azimuth_rad, Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(plane.elevation_rad, Eigen::Vector3d::UnitX()) *
                 Eigen::AngleAxisd(plane.roll_rad, Eigen::Vector3d::UnitZ()))
                    .toRotationMatrix();
}

ScanPlane turned(const Eigen::Vector3d& angles_deg) {
  return {Eigen::Vector3d::Zero(), angles_deg.x() * kRadian, angles_deg.y() * kRadian, angles_deg.z() * kRadian};
}

/// Moves a plane along its normal until it touches the solid; `side` is -1 for a first plane, +1 for a last. Its
/// reference point is the foot of the perpendicular from the object's middle.
Contact touch(const Solid& solid, const Eigen::Matrix3d& view, double side, ScanPlane& plane) {
  const Eigen::Vector3d outward = side * rotation(view, plane).col(2);
  const Contact contact = solid.contact(outward);
  const double clearance = contact.on_face ? -kFaceDepth_mm : kClearance_mm;
  plane.position_mm = (contact.point_mm.dot(outward) + clearance) * outward;
  return contact;
}

/// Turns a plane about the fan's axis, where it already lies, until it touches the solid.
Contact tilt(const Solid& solid, const Eigen::Matrix3d& view, double side, ScanPlane& plane) {
  const auto beyond_mm = [&](double elevation_rad) {
    plane.elevation_rad = elevation_rad;
    const Eigen::Vector3d outward = side * rotation(view, plane).col(2);
    return (solid.contact(outward).point_mm - plane.position_mm).dot(outward);
  };
  // Looking along depth the solid lies on both sides of the plane; at a right angle to it, behind the plane.
  double cutting = 0.0;
  double clear = side * std::numbers::pi / 2.0;
  while (std::abs(clear - cutting) > 1e-14) {
    const double middle = (cutting + clear) / 2.0;
    if (middle == cutting || middle == clear) break;
    (beyond_mm(middle) > -kClearance_mm ? cutting : clear) = middle;
  }
  plane.elevation_rad = clear;
  return solid.contact(side * rotation(view, plane).col(2));
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

ScanPath make_scan_path(const Phantom& phantom, const ScanGeometry& geometry) {
  ScanPath path;
  path.view << geometry.depth.cross(geometry.sweep), geometry.depth, geometry.sweep;
  path.first = turned(geometry.first_deg);
  path.last = turned(geometry.last_deg);
  // Not in the middle of a pixel, where points of contact would often fall.
  path.anchor_px = Eigen::Vector2d(kImageSize.width * 0.5 + 0.23, kImageSize.height * 0.5 + 0.37);
  if (geometry.fan_axis) {
    path.anchor_px.y() = kImageSize.height * kFanDepth;
    const double extent_mm = -phantom.solid->contact(-geometry.depth).point_mm.dot(geometry.depth);
    path.first.position_mm = path.last.position_mm = -*geometry.fan_axis * extent_mm * geometry.depth;
    path.first_contact = tilt(*phantom.solid, path.view, -1.0, path.first);
    path.last_contact = tilt(*phantom.solid, path.view, 1.0, path.last);
  } else {
    path.first_contact = touch(*phantom.solid, path.view, -1.0, path.first);
    path.last_contact = touch(*phantom.solid, path.view, 1.0, path.last);
  }
  return path;
}

ScanPath make_scan_path(const Phantom& phantom, const std::string& pattern) {
  const ScanGeometry* general = nullptr;
  for (const ScanGeometry& geometry : scan_table()) {
    if (pattern != geometry.pattern) continue;
    if (phantom.name == geometry.object) return make_scan_path(phantom, geometry);
    if (std::string(geometry.object).empty()) general = &geometry;
  }
  if (general == nullptr) refuse_choice("pattern", pattern, pattern_names());
  return make_scan_path(phantom, *general);
}

std::vector<std::string> pattern_names() {
  std::vector<std::string> names;
  for (const ScanGeometry& geometry : scan_table()) {
    if (std::string(geometry.object).empty()) names.emplace_back(geometry.pattern);
  }
  return names;
}

}  // namespace fathom
