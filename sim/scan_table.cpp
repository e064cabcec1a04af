#include "sim/scan_table.h"

#include <array>
#include <cmath>
#include <numbers>

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

Eigen::Vector3d deg(double azimuth, double elevation, double roll) { return {azimuth, elevation, roll}; }

}  // namespace

// Treece 2000 prints the errors of its scans (table 2.1), but most of their geometry only in pictures. The angles here
// are those at which linear planimetry has the published error at 20 planes.
std::span<const ScanGeometry> scan_table() {
  // The probe lies across the cone's side, turned by 20 degrees towards the base.
  const Eigen::Vector3d from_side_of_cone(std::sin(70.0 * kRadian), 0.0, std::cos(70.0 * kRadian));
  static const std::array table = {
      ScanGeometry{"", "linear", kX, -kZ, deg(0, 0, 0), deg(0, 0, 0), {}},
      ScanGeometry{"", "linear-y", kY, -kZ, deg(0, 0, 0), deg(0, 0, 0), {}},
      ScanGeometry{"", "oblique", kX, -kZ, deg(30, 20, 0), deg(30, 20, 0), {}},
      ScanGeometry{"", "fan", kX, -kZ, deg(0, 0, 0), deg(0, 0, 0), 1.3},
      ScanGeometry{"", "free", kX, -kZ, deg(-25, -25, -5), deg(25, 25, 5), {}},
      ScanGeometry{"sphere", "fan", kX, -kZ, deg(0, 0, 0), deg(0, 0, 0), 1.02},
      ScanGeometry{"sphere", "free", kX, -kZ, deg(-41, -41, -5), deg(41, 41, 5), {}},
      ScanGeometry{"ellipsoid", "free", kY, -kZ, deg(-40, -40, -5), deg(40, 40, 5), {}},
      ScanGeometry{"cone", "linear", -kZ, kX, deg(0, 0, 0), deg(0, 0, 0), {}},
      ScanGeometry{"cone", "fan", kY, from_side_of_cone, deg(0, 0, 0), deg(0, 0, 0), 1.01},
      ScanGeometry{"cube", "free", kX, -kZ, deg(-7, -10, -5), deg(7, 10, 5), {}},
      ScanGeometry{"glove", "free", kY, -kZ, deg(-72, -50, -5), deg(72, 50, 5), {}},
      ScanGeometry{"hat", "linear", kZ, kX, deg(0, 0, 0), deg(0, 0, 0), {}},
      ScanGeometry{"hat", "free", kZ, kX, deg(-50, -30, -5), deg(50, 30, 5), {}},
  };
  return table;
}

}  // namespace fathom
