#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace fathom {

/// How a simulated scanner sees tissue.
struct SpeckleOptions {
  double lateral_mm = 0.9;         ///< full width at half height of the response to a point, along image x
  double axial_mm = 0.45;          ///< the same along image y
  double elevation_mm = 1.5;       ///< the same across the image
  double dynamic_range_db = 60.0;  ///< from black to white
  double tissue_db = -22.0;        ///< mean echo of tissue below white, at the probe
  double structure_db = -16.0;     ///< what the inside of an object is darker by than tissue (negative)
  double boundary_db = 20.0;       ///< of a boundary across the beam above tissue; fades as it turns along the beam
  double attenuation_db_per_mm = 0.08;  ///< left over after the scanner's gain compensation, both ways
  std::uint64_t seed = 1;
  /// Throws Error when a value is out of range.
  void check() const;
};

/// Fully developed speckle that is fixed in space: frames that overlap or lie close to each other show the same
/// texture. White complex Gaussian noise on a lattice in space, hashed so that it does not repeat, averaged over the
/// probe's resolution cell, which turns with the probe. May be used from several threads.
class SpeckleField {
 public:
  /// Throws Error as SpeckleOptions::check.
  explicit SpeckleField(const SpeckleOptions& options);

  /// Echo amplitude of uniform tissue before compression, CV_32FC1: Rayleigh distributed, mean square 1.
  /// `phantom_from_image` maps pixels (z = 0) to mm, its first two columns perpendicular.
  cv::Mat amplitude(const Eigen::Affine3d& phantom_from_image, cv::Size size) const;

 private:
  SpeckleOptions options_;
  std::shared_ptr<const std::vector<cv::Vec2f>> noise_;
};

/// The B-scan of an object: `inside` (CV_8UC1, not 0 inside) says where it is. Tissue around it, darker speckle
/// inside, boundaries bright where they lie across the beam, attenuation with depth, log compression. CV_8UC1.
cv::Mat speckled_image(const SpeckleField& field, const SpeckleOptions& options, const cv::Mat& inside,
                       const Eigen::Affine3d& phantom_from_image);

/// 8-bit grey values of amplitudes (1 is white): log compression of `dynamic_range_db`.
cv::Mat log_compressed(const cv::Mat& amplitude, double dynamic_range_db);

/// Blackens what a curved probe does not see: outside the sector of `half_angle_rad` about image y whose apex lies
/// `apex_px` above the image's top edge in the middle column, and within `face_px` of the apex.
void blacken_outside_fan(cv::Mat& image, double apex_px, double face_px, double half_angle_rad);

}  // namespace fathom
