#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace fathom {

/// A named place in some frame.
struct Landmark {
  std::string name;  ///< empty where the file has none
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
};

/// Reads lines of `x,y,z` or `name,x,y,z` in mm (docs/file-formats.md). Throws Error naming the line when the file is
/// damaged, has lines of both kinds, a name twice, more than 1000 landmarks, or is longer than 1 MB.
std::vector<Landmark> read_landmarks(const std::filesystem::path& path);

}  // namespace fathom
