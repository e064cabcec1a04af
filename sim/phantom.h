#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "sim/solid.h"

namespace fathom {

/// An object to scan and the depth setting it is scanned with.
struct Phantom {
  std::string name;
  std::shared_ptr<const Solid> solid;
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Ones();  ///< width and height of a pixel
};

/// All B-scans are of this size.
inline const cv::Size kImageSize{330, 420};

/// The test objects of Treece 2000, appendix A.1, which just fit a cube of 20 mm and are scanned at 0.12 mm, and organs
/// at their own size. Throws Error, naming the choice, for any other name.
Phantom make_phantom(const std::string& name);

std::vector<std::string> object_names();

}  // namespace fathom
