#pragma once

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"
#include "measurement/contour_surface.h"
#include "registration/partition.h"
#include "surface/mesh_check.h"
#include "tests/measurement/sphere_scan.h"

// A ball seen by several sweeps, with planes between them.
namespace fathom::ball_scans {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRadius = 10.0;
inline constexpr double kBall_ml = 4.0 / 3.0 * kPi * kRadius * kRadius * kRadius / 1000.0;

inline ContourSurfaceOptions spaced(double spacing_mm, GapOrder order = GapOrder::kLinear) {
  ContourSurfaceOptions options;
  options.order = order;
  options.spacing_mm = spacing_mm;
  return options;
}

// Volume of the part of a ball that lies more than `height_mm` from its centre, on one side.
inline double segment_ml(double height_mm) {
  const double h = kRadius - height_mm;
  return kPi * h * h * (3.0 * kRadius - h) / 3.0 / 1000.0;
}

inline SweepShape one_centre(const Eigen::Vector3d& centre_mm) { return {{centre_mm}, {centre_mm}, {centre_mm}}; }

inline Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

// Sweeps over a ball about `centre`, one along every direction, each over all of it.
struct Scan {
  std::vector<Sweep> sweeps;
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  Scan(const std::vector<Eigen::Vector3d>& directions, int frames, const Eigen::Vector3d& ball_centre)
      : centre(ball_centre) {
    for (const Eigen::Vector3d& direction : directions) {
      const int first = static_cast<int>(poses.size());
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction);
      for (const double along : evenly(-kRadius, kRadius, frames)) {
        poses.emplace_back(Eigen::Translation3d(centre + 0.999 * along * direction) * turn);
      }
      sweeps.push_back({0, first, static_cast<int>(poses.size()) - 1});
    }
  }

  FrameLocator locator() const { return scan_of(poses, 0.1); }
};

inline void expect_closed(const Mesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold() && topology.oriented());
}

struct TwoSweeps {
  Scan scan;
  DividingPlane plane;
  SpacePartition partition;
};

// The plane lies `height` from the centre of the ball; sweep 0 is used on its positive side.
inline TwoSweeps two_sweeps(Random& random, double height, int frames = 41) {
  const Eigen::Vector3d centre(12.0, -5.0, 80.0);
  const Eigen::Vector3d normal = random_direction(random);
  Scan scan({random_direction(random), random_direction(random)}, frames, centre);
  const DividingPlane plane(normal, centre + height * normal);
  SpacePartition partition({one_centre(centre + 50.0 * normal), one_centre(centre - 50.0 * normal)}, {plane});
  return {scan, plane, partition};
}

}  // namespace fathom::ball_scans
