#include <array>
#include <cmath>
#include <numbers>

#include "sim/scan_plan.h"

namespace fathom {

namespace {

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();

/// The direction of the beam from a window that lies to one side of the object, by an angle about x.
Eigen::Vector3d depth(double side_deg) {
  const double side = side_deg * std::numbers::pi / 180.0;
  return {0.0, std::sin(side), -std::cos(side)};
}

/// A sweep along x: azimuth, elevation and roll of the first and last planes, in degrees.
ScanGeometry sweep(double across, double side_deg, const Eigen::Vector3d& first_deg, const Eigen::Vector3d& last_deg,
                   std::optional<double> fan_axis = {}) {
  return {"", "", kX, depth(side_deg), first_deg, last_deg, fan_axis, across};
}

ScanGeometry straight(double across, double side_deg = 0.0) {
  return sweep(across, side_deg, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
}

ScanGeometry fan(double across, double axis, double side_deg = 0.0) {
  return sweep(across, side_deg, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), axis);
}

}  // namespace

std::span<const SweepPattern> sweep_table() {
  static const std::array<SweepPattern, 8> table = {{
      {"sweeps-a", {0.64, 1.5}, {straight(-0.5), straight(0.5)}},
      {"sweeps-b", {1.10, 1.9}, {sweep(-0.5, -15, {0, -15, 0}, {0, 15, 0}), sweep(0.5, 15, {0, -15, 0}, {0, 15, 0})}},
      {"sweeps-c", {1.60, 1.5}, {sweep(-0.5, 0, {10, 0, 0}, {70, 0, 0}), sweep(0.5, 0, {-10, 0, 0}, {-70, 0, 0})}},
      {"sweeps-d", {0.50, 1.5}, {straight(-0.90), straight(0), straight(0.90)}},
      {"sweeps-e",
       {0.70, 1.9},
       {sweep(-0.8, -15, {0, -10, 0}, {0, 10, 0}), sweep(0, 0, {0, -10, 0}, {0, 10, 0}),
        sweep(0.8, 15, {0, -10, 0}, {0, 10, 0})}},
      {"sweeps-f", {0.50, 2.4}, {fan(-0.90, 1.6), fan(0, 1.6), fan(0.90, 1.6)}},
      {"sweeps-g",
       {0.70, 1.6},
       {sweep(-0.90, 0, {-15, -20, 0}, {15, 20, 0}), sweep(0, 0, {-15, -20, 0}, {15, 20, 0}),
        sweep(0.90, 0, {-15, -20, 0}, {15, 20, 0})}},
      {"sweeps-h", {0.70, 2.4}, {straight(-0.90), fan(0, 1.6), sweep(0.90, 0, {-10, -20, 0}, {10, 20, 0})}},
  }};
  return table;
}

}  // namespace fathom
