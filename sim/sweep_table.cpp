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

Eigen::Vector3d deg(double azimuth, double elevation) { return {azimuth, elevation, 0.0}; }

/// A sweep along x, `across` and the window's side as named; a fan has an axis.
ScanGeometry sweep(double across, double side_deg, const Eigen::Vector3d& first_deg, const Eigen::Vector3d& last_deg,
                   std::optional<double> fan_axis = {}) {
  return {"", "", kX, depth(side_deg), first_deg, last_deg, fan_axis, across};
}

ScanGeometry straight(double across) { return sweep(across, 0, deg(0, 0), deg(0, 0)); }

ScanGeometry fan(double across, double side_deg, double azimuth_deg, double axis) {
  return sweep(across, side_deg, deg(azimuth_deg, 0), deg(azimuth_deg, 0), axis);
}

}  // namespace

// Treece 2000 shows figure 4.10 as pictures only: (a) to (c) are two sweeps, (d) to (h) three; in (c) the B-scans are
// not parallel and the dividing plane cuts them at an acute angle. What is more was chosen so that linear planimetry
// has the published errors (table 4.1) with as many sections as published, over the four objects together, as nearly as
// could be found: (b) and (d) to (h) among some hundred sets of angles and sizes tried at random, (c) among four sets
// tried by hand, since the search's own left parts of the box out. (a) is parallel and was written down by hand; (d)
// came out of the search parallel. The images of (b) were made wider afterwards, until no part of an object lay
// outside the images of the sweep that is used there. No number was chosen by what cubic planimetry makes of it.
std::span<const SweepPattern> sweep_table() {
  static const std::array<SweepPattern, 8> table = {{
      {"sweeps-a", {0.64, 1.5}, {straight(-0.5), straight(0.5)}},
      {"sweeps-b", {1.20, 1.9}, {sweep(-0.5, 0, deg(22, -1), deg(-6, 29)), sweep(0.5, 0, deg(-22, -1), deg(6, 29))}},
      {"sweeps-c", {1.60, 1.6}, {sweep(-0.5, 0, deg(10, 0), deg(70, 0)), sweep(0.5, 0, deg(-10, 0), deg(-70, 0))}},
      {"sweeps-d", {0.56, 1.5}, {straight(-0.95), straight(0), straight(0.95)}},
      {"sweeps-e",
       {0.75, 1.9},
       {sweep(-0.8, -21, deg(10, -35), deg(10, 15)), sweep(0, 0, deg(10, -35), deg(10, 15)),
        sweep(0.8, 21, deg(10, -35), deg(10, 15))}},
      {"sweeps-f", {0.75, 2.5}, {fan(-0.85, -19, 12, 1.83), fan(0, 0, 12, 1.83), fan(0.85, 19, 12, 1.83)}},
      {"sweeps-g",
       {0.85, 1.7},
       {sweep(-0.85, 0, deg(-25, -6), deg(31, 6)), sweep(0, 0, deg(-25, -6), deg(31, 6)),
        sweep(0.85, 0, deg(-25, -6), deg(31, 6))}},
      {"sweeps-h",
       {0.75, 3.4},
       {sweep(-0.85, 0, deg(0, 11), deg(0, 11)), fan(0, 0, 0, 2.96), sweep(0.85, 0, deg(-7, -29), deg(7, 29))}},
  }};
  return table;
}

}  // namespace fathom
