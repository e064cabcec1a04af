#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/phantom.h"

namespace fathom {

/// Where a scan plane lies: the place of its reference point, in the phantom's coordinates, and how it is turned, all
/// that Treece 2000, appendix A.1 interpolates and disturbs.
struct ScanPlane {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  double azimuth_rad = 0.0;    ///< about the image's y axis
  double elevation_rad = 0.0;  ///< then about the image's x axis
  double roll_rad = 0.0;       ///< then within the plane

  ScanPlane operator+(const ScanPlane& other) const;
  ScanPlane operator*(double factor) const;
};

/// A sweep from a first to a last plane, which touch the object from outside.
struct ScanPath {
  /// Columns: image x, image y (away from the probe) and the sweep's direction, before the plane is turned.
  Eigen::Matrix3d view = Eigen::Matrix3d::Identity();
  Eigen::Vector2d anchor_px = Eigen::Vector2d::Zero();  ///< the pixel that lies at ScanPlane::position_mm
  ScanPlane first;
  ScanPlane last;
  Contact first_contact;  ///< in the phantom's coordinates
  Contact last_contact;

  /// The plane at `u`: 0 the first, 1 the last; continued in the same way below 0 and above 1.
  ScanPlane at(double u) const;

  Eigen::Affine3d phantom_from_image(const ScanPlane& plane, const Eigen::Vector2d& pixel_mm) const;
};

/// One line of the table of scans: how an object is swept in a pattern.
struct ScanGeometry {
  const char* object;  ///< empty: any object that has no line of its own
  const char* pattern;
  Eigen::Vector3d sweep;      ///< direction in which the planes advance
  Eigen::Vector3d depth;      ///< direction of the image's y axis
  Eigen::Vector3d first_deg;  ///< azimuth, elevation, roll of the first plane
  Eigen::Vector3d last_deg;   ///< and of the last
  /// A fan turns about an axis along image x that lies before the object's middle, by this many times the object's
  /// extent towards the probe; its elevations follow from touching the object. Empty: not a fan.
  std::optional<double> fan_axis;
};

/// The path of a pattern around a phantom. Throws Error, naming the choice, for an unknown pattern.
ScanPath make_scan_path(const Phantom& phantom, const std::string& pattern);
ScanPath make_scan_path(const Phantom& phantom, const ScanGeometry& geometry);

std::vector<std::string> pattern_names();

}  // namespace fathom
