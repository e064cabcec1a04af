#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "sim/scene.h"
#include "sim/solid.h"

namespace fathom {

/// One of the structures that an object consists of.
struct PhantomPart {
  std::string name;
  std::shared_ptr<const Solid> solid;  ///< in the phantom's coordinates, where its extents need not be centred
};

/// B-scans of the test objects are of this size.
inline const cv::Size kImageSize{330, 420};

/// An object to scan and the depth setting it is scanned with.
struct Phantom {
  std::string name;
  std::shared_ptr<const Solid> solid;                  ///< all of it
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Ones();  ///< width and height of a pixel
  cv::Size image_size = kImageSize;
  std::vector<PhantomPart> parts;  ///< what is outlined, at least one
  std::vector<SceneBody> bodies;   ///< how it looks in a scene; empty: as speckled_image shows it
};

/// The test objects of Treece 2000, appendix A.1, which just fit a cube of 20 mm and are scanned at 0.12 mm, and organs
/// at their own size. Throws Error, naming the choice, for any other name.
Phantom make_phantom(const std::string& name);

std::vector<std::string> object_names();

/// The scene "bladder" with other semi-axes, bent by the same share of its height, scanned at another depth: square
/// pixels of `pixel_mm`. Its volume is that of the ellipsoid.
Phantom make_bladder(const Eigen::Vector3d& semi_axes_mm, double pixel_mm);

}  // namespace fathom
