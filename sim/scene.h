#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "sim/solid.h"
#include "sim/speckle.h"

namespace fathom {

/// How a body shows in a scene.
struct SceneBody {
  std::shared_ptr<const Solid> solid;
  double level_db = 0.0;          ///< mean echo against tissue
  double behind_db_per_mm = 0.0;  ///< what the beam gains (fluid) or loses (bone) in it
  bool drops_out = true;          ///< a share of its outline is not visible
};

/// Speckled B-scans of bodies in tissue, with the faults of ultrasound: outlines that are not visible in places,
/// shadows, enhancement behind fluid. All of it is fixed in space, and as sim/scene_constants.h says. The beam runs
/// along image y. May be used from several threads.
class Scene {
 public:
  /// Later bodies cover earlier ones. `seed` decides about the texture and where the faults lie; the same seed gives
  /// the same images. The probe is expected at +z.
  Scene(std::vector<SceneBody> bodies, std::uint64_t seed);

  /// CV_8UC1. `phantom_from_image` maps pixels (z = 0) to mm, its first two columns perpendicular.
  cv::Mat image(const Eigen::Affine3d& phantom_from_image, cv::Size size) const;

  /// The mean echo against tissue at the probe in dB, CV_32FC1: the image without speckle.
  cv::Mat level_db(const Eigen::Affine3d& phantom_from_image, cv::Size size) const;

 private:
  struct Wave {
    Eigen::Vector3d per_mm;
    double phase_rad;
  };

  void place_shadows(std::uint64_t seed);
  double pattern(const Eigen::Vector3d& x_mm) const;
  double pattern_quantile(double share, std::uint64_t seed) const;
  cv::Mat pattern_image(const Eigen::Affine3d& phantom_from_image, cv::Size size) const;

  std::vector<SceneBody> bodies_;
  SpeckleOptions speckle_;
  SpeckleField field_;
  std::array<Wave, 24> waves_;
  double threshold_ = 0.0;  ///< where the pattern is larger, either way, the outline is not visible
};

}  // namespace fathom
