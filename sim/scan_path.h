#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/phantom.h"
#include "sim/solid_part.h"

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

/// A sweep from a first to a last plane, between which the object lies, or the part of it that the sweep is to show.
struct ScanPath {
  /// Columns: image x, image y (away from the probe) and the sweep's direction, before the plane is turned.
  Eigen::Matrix3d view = Eigen::Matrix3d::Identity();
  Eigen::Vector2d anchor_px = Eigen::Vector2d::Zero();  ///< the pixel that lies at ScanPlane::position_mm
  ScanPlane first;
  ScanPlane last;
  /// Where the first and last planes touch the object from outside, in the phantom's coordinates; empty where one lies
  /// in a flat face or cuts the object.
  std::optional<Eigen::Vector3d> first_touch_mm;
  std::optional<Eigen::Vector3d> last_touch_mm;

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
  /// The images' middle lies beside the object's middle, along image x, by this many times half the object's extent.
  double across = 0.0;
};

/// The path of a pattern of one sweep around a phantom; the pattern is one of single_sweep_patterns().
ScanPath make_scan_path(const Phantom& phantom, const std::string& pattern);

/// The path between the planes that touch `part`, in images of `image_size`. Planes that touch less than the whole
/// object are moved into the part by a hundredth of the object's radius: they are close to its edge, but cut it, and so
/// have a cross-section there.
ScanPath make_scan_path(const Phantom& phantom, const ScanGeometry& geometry, const SolidPart& part,
                        cv::Size image_size);

std::vector<std::string> single_sweep_patterns();

}  // namespace fathom
