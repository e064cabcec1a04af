#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fathom {

/// A straight wire between two plates, in phantom coordinates (mm).
struct Wire {
  std::string name;
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  Eigen::Vector3d back = Eigen::Vector3d::Zero();
};

/// Three wires in one plane that look like an N from above: the outer two are parallel, the middle one joins the
/// front of the first to the back of the third. An image plane that cuts all three shows three points on a line,
/// and their ratio tells where it cuts the middle wire.
using NPattern = std::array<Wire, 3>;

/// Where the wires of an N-wire phantom are.
struct WirePhantom {
  std::string name;
  std::vector<NPattern> patterns;
  /// The phantom's registration, where it is known beforehand; else it is estimated with the calibration.
  std::optional<Eigen::Isometry3d> reference_from_phantom;
};

/// One wire as seen in one frame.
struct WirePoint {
  int frame = 0;            ///< as stored
  std::size_t pattern = 0;  ///< index into WirePhantom::patterns
  std::size_t wire = 0;     ///< 0 to 2
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
};

}  // namespace fathom
